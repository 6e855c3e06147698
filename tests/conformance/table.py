"""The table of docs/conformance.md: `python -m tests.conformance.table RESULT.json...`.

Each file is what `ifgen conformance --json` wrote; the columns are in this order.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

PAGE: Final = Path(__file__).resolve().parents[2] / "docs/conformance.md"
BEGIN: Final = "<!-- python -m tests.conformance.table writes this -->\n"
END: Final = "<!-- to here -->\n"


def lines(results: Sequence[dict[str, Any]]) -> Iterator[str]:
    """The rows: a group each, with the cases that each testee passed of those that it could be asked."""
    about = [result["testee"] for result in results]
    names = [f"{one['language']}, {one.get('library', '')}".rstrip(", ") for one in about]
    yield f"| cases | {' | '.join(names)} |"
    yield f"|---|{'---:|' * len(names)}"
    totals = [[0, 0] for _ in results]
    for group in sorted({group for result in results for group in result["groups"]}):
        cells = []
        for result, total in zip(results, totals, strict=True):
            counts = result["groups"].get(group, {})
            passed = counts.get("passed", 0)
            asked = passed + counts.get("failed", 0) + counts.get("expected", 0)
            total[0] += passed
            total[1] += asked
            cells.append(_cell(passed, asked))
        yield f"| {group} | {' | '.join(cells)} |"
    yield f"| **all** | {' | '.join(_cell(passed, asked) for passed, asked in totals)} |"


def _cell(passed: int, asked: int) -> str:
    if not asked:
        return "-"
    return f"{passed:,}" if passed == asked else f"{passed:,} of {asked:,}"


def main() -> None:
    """Replace the table in the page."""
    results = [json.loads(Path(path).read_text()) for path in sys.argv[1:]]
    before, _, rest = PAGE.read_text().partition(BEGIN)
    _, _, after = rest.partition(END)
    PAGE.write_text(before + BEGIN + "".join(f"{line}\n" for line in lines(results)) + END + after)


if __name__ == "__main__":
    main()

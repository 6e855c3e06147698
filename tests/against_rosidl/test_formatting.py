"""`ifgen fmt` changes how a file looks and nothing that rosidl reads in it, and twice is as once."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import Phase, given, settings
from ifgen.diagnostics import InputError, Source
from ifgen.formatting import formatted

from .conftest import Reference, Refused
from .test_mutations import REAL, changed_files, inputs

OURS = sorted(
    path
    for kind in ("msg", "srv", "action")
    for path in (Path(__file__).parents[2] / "interfaces").glob(f"*/{kind}/*.{kind}")
)


def check(kind: str, text: str, rosidl: Reference) -> None:
    """Compare what rosidl reads before and after, for what ifgen formats at all."""
    source = Source(Path(f"Sample.{kind}"), text.replace("\r\n", "\n"))
    try:
        after = formatted(source)
    except InputError as error:
        assert "unsafe-format" not in {problem.rule for problem in error.diagnostics}
        return
    assert formatted(Source(source.path, after)) == after
    # Spaces at the end of a comment are kept by rosidl, and not by us.
    before = rosidl.adapter(kind, "\n".join(line.rstrip() for line in source.text.splitlines()))
    if not isinstance(before, Refused):
        assert rosidl.adapter(kind, after) == before


@pytest.mark.parametrize("path", [*REAL, *OURS], ids=lambda path: "/".join(path.parts[-3:]))
def test_real_files(path: Path, rosidl: Reference) -> None:
    check(path.suffix[1:], path.read_text(encoding="utf-8"), rosidl)


@settings(max_examples=100, phases=[Phase.explicit, Phase.generate])
@given(inputs)
def test_lines_put_together(rosidl: Reference, file: tuple[str, str]) -> None:
    check(*file, rosidl)


@pytest.mark.slow
@settings(max_examples=3000, phases=[Phase.explicit, Phase.generate])
@given(inputs)
def test_many_lines_put_together(rosidl: Reference, file: tuple[str, str]) -> None:
    check(*file, rosidl)


@pytest.mark.slow
@settings(max_examples=3000, phases=[Phase.explicit, Phase.generate])
@given(changed_files())
def test_real_files_with_changes(rosidl: Reference, file: tuple[str, str]) -> None:
    check(*file, rosidl)

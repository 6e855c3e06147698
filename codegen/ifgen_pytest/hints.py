"""Advice for a test that imports something from a transport when none is set."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

_WAY = """run `pytest --transport local` (or rclpy, auto, both),
or write `transport = "local"` under [tool.pytest.ini_options]"""


def hint(error: BaseException | None) -> str | None:
    """Advice for a missing module that is in the project's output folder, or comes with ifgen."""
    for name in _missing(error):
        # Imported here: most test runs have nothing to do with ROS.
        from ifgen import resources
        from ifgen.config.settings import settle
        from ifgen.diagnostics import UsageError

        try:
            output = settle().output
        except UsageError:
            continue
        if (output / name).is_dir():
            return f"'{name}' is in {os.path.relpath(output)}: {_WAY}"
        folders = (resources.underlay(), resources.bundled_generated(), resources.libraries())
        if any((folder / name).is_dir() for folder in folders):
            return f"'{name}' comes with ifgen: {_WAY}"
    return None


def skips(reports: Iterable[Any]) -> Iterator[str]:
    """The reasons why files of tests that ifgen generated were skipped, with commands that help."""
    found: Counter[str] = Counter()
    for report in reports:
        if isinstance(report.longrepr, tuple):  # file, line, reason
            _, ours, reason = str(report.longrepr[2]).partition("Skipped: ifgen: ")
            if ours:
                found[reason] += 1
    for reason, count in found.items():
        line = f"ifgen: {count} {'file' if count == 1 else 'files'} skipped: {reason}"
        if "hypothesis" in reason:
            from ifgen.config.installing import add_extra  # most test runs skip nothing

            line = f"{line}: run `{add_extra('test')}`"
        yield line


def _missing(error: BaseException | None) -> Iterator[str]:
    while error is not None:
        if isinstance(error, ModuleNotFoundError) and error.name:
            yield error.name.partition(".")[0]
        error = error.__cause__ or error.__context__

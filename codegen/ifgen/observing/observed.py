"""Runs an observer beside the programs that it looks at."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal, TypeVar

from ifgen_tools.running import run

from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError

SeenT = TypeVar("SeenT")


def observe(
    programs: Sequence[list[str]],
    observer: Callable[[Path], list[str]],
    read: Callable[[Path], SeenT | None],
    transport: Literal["local", "rclpy", "auto"],
    rule: Literal["no-graph", "no-node"],
) -> SeenT:
    """Run an observer after the programs, and return what it saw. All end with it; stdout is not theirs.

    `observer` returns its arguments for the file that it is to write, and `read` what is in that. Raises
    UsageError, by a rule, if the observer wrote nothing.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "seen.json"
        with run.stdout_to_stderr():
            code = run.run([*programs, observer(file)], transport, settle().output, tells=not programs)
        seen = read(file)
    if seen is None:
        what = rule.removeprefix("no-")
        message = f"the {what} could not be observed: the programs ended with exit code {code}"
        raise UsageError([Diagnostic(rule, message, help="run them with `ifgen run` to see why")])
    return seen

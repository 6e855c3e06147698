"""Runs one program in this process, as Python itself would."""

from __future__ import annotations

import sys
from typing import Any

from ifgen.running import processes
from ifgen.running.ending import exit_code, is_interruption, tell
from ifgen.running.program import Program


def run(program: Program) -> int:
    """Run a program to its end; returns its exit code. What it leaves running ends with this process."""
    try:
        program.execute()
    except BaseException as ending:
        _be_quiet_when_dismissed()
        if processes.is_dismissed() and is_interruption(ending):
            return 0
        tell(ending)
        return exit_code(ending)
    _be_quiet_when_dismissed()
    return 0


def _be_quiet_when_dismissed() -> None:
    """Say nothing of an interruption of ours while Python waits for the threads that the program has left."""
    report = sys.unraisablehook

    def report_others(error: Any) -> None:
        if not (processes.is_dismissed() and is_interruption(error.exc_value)):
            report(error)

    sys.unraisablehook = report_others

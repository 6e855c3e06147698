"""Runs one program in this process, as Python itself would."""

from __future__ import annotations

import _thread
import sys
from collections.abc import Callable
from functools import partial
from io import TextIOWrapper
from typing import Any

from ifgen_tools.running import processes
from ifgen_tools.running.ending import exit_code, is_interruption, tell
from ifgen_tools.running.program import Program


def run(program: Program) -> int:
    """Run a program to its end; returns its exit code. What it leaves running ends with this process."""
    note = processes.take_note()
    ending: BaseException | None = None
    report = sys.unraisablehook
    sys.unraisablehook = partial(_hear_again, report)
    try:
        if note is not None:
            processes.let_signals_come()
            _write_whole_lines()
        program.execute()
    except BaseException as error:
        ending = error
    finally:
        if getattr(sys.unraisablehook, "func", None) is _hear_again:  # else the program has its own
            sys.unraisablehook = report

    def is_dismissed() -> bool:
        return note is not None and note.exists()

    _be_quiet_when(is_dismissed)
    if ending is not None and not (is_interruption(ending) and is_dismissed()):
        tell(ending)
        return exit_code(ending)
    return 0


def _hear_again(report: Callable[[Any], object], error: Any) -> None:
    """Let Ctrl-C interrupt the program where Python would drop it, as in the callback of a weak reference."""
    if isinstance(error.exc_value, KeyboardInterrupt):
        _thread.interrupt_main()
    else:
        report(error)


def _write_whole_lines() -> None:
    """Write each line at once and whole, also to a file or a pipe: other programs write there, too."""
    streams: tuple[object, ...] = (sys.stdout, sys.stderr)
    for stream in streams:
        if isinstance(stream, TextIOWrapper):  # None, where there is no output
            stream.reconfigure(line_buffering=True, write_through=False)


def _be_quiet_when(is_dismissed: Callable[[], bool]) -> None:
    """Say nothing of an interruption of ours while Python waits for the threads that the program has left."""
    report = sys.unraisablehook

    def report_others(error: Any) -> None:
        if not (is_interruption(error.exc_value) and is_dismissed()):
            report(error)

    sys.unraisablehook = report_others

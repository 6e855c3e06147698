"""Assertions about the output and the exit codes of processes."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final, Literal

from launch.actions import ExecuteLocal

from launch_testing.util import NO_CMD_ARGS, resolveProcesses

if TYPE_CHECKING:
    from launch_testing.io_handler import IoHandler
    from launch_testing.proc_info_handler import ProcInfoHandler

__all__ = [
    "EXIT_FORCED",
    "EXIT_OK",
    "EXIT_SIGINT",
    "EXIT_SIGKILL",
    "EXIT_SIGQUIT",
    "EXIT_SIGSEGV",
    "EXIT_SIGTERM",
    "NO_CMD_ARGS",
    "SequentialTextChecker",
    "assertExitCodes",
    "assertInStderr",
    "assertInStdout",
    "assertInStream",
    "assertSequentialStdout",
]

EXIT_OK: Final = 0
EXIT_SIGINT: Final = 130
EXIT_SIGQUIT: Final = 131
EXIT_SIGKILL: Final = 137
EXIT_SIGSEGV: Final = 139
EXIT_SIGTERM: Final = 143
EXIT_FORCED: Final = 1 if os.name == "nt" else -2

Pattern = str | re.Pattern[str]
Expected = Pattern | Sequence[Pattern]

_ESCAPE: Final = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]")


def assertInStdout(
    proc_output: IoHandler,
    expected_output: Expected,
    process: ExecuteLocal | str | None,
    cmd_args: str | Sequence[str] | None = None,
    *,
    output_filter: Callable[[str], str] | None = None,
    strict_proc_matching: bool = True,
    strip_ansi_escape_sequences: bool = True,
) -> None:
    """Assert that a process has written a text, a pattern, or lines or patterns in this order, to stdout."""
    _assert_in(
        proc_output,
        expected_output,
        resolveProcesses(
            proc_output, process=process, cmd_args=cmd_args, strict_proc_matching=strict_proc_matching
        ),
        output_filter,
        strips=strip_ansi_escape_sequences,
        descriptor=1,
    )


def assertInStderr(
    proc_output: IoHandler,
    expected_output: Expected,
    process: ExecuteLocal | str | None,
    cmd_args: str | Sequence[str] | None = None,
    *,
    output_filter: Callable[[str], str] | None = None,
    strict_proc_matching: bool = True,
    strip_ansi_escape_sequences: bool = True,
) -> None:
    """Assert the same of stderr, where nodes log."""
    _assert_in(
        proc_output,
        expected_output,
        resolveProcesses(
            proc_output, process=process, cmd_args=cmd_args, strict_proc_matching=strict_proc_matching
        ),
        output_filter,
        strips=strip_ansi_escape_sequences,
        descriptor=2,
    )


def assertInStream(
    proc_output: IoHandler,
    expected_output: Expected,
    process: ExecuteLocal | str | None,
    cmd_args: str | Sequence[str] | None = None,
    *,
    stream: Literal["stdout", "stderr"] = "stderr",
    **options: Any,
) -> None:
    """Assert the same of the stream that is named. Raises ValueError for another name."""
    checks = {"stdout": assertInStdout, "stderr": assertInStderr}
    if stream not in checks:
        raise ValueError(f"stream must be 'stdout' or 'stderr', got {stream!r}")
    checks[stream](proc_output, expected_output, process, cmd_args, **options)


def _assert_in(
    proc_output: IoHandler,
    expected: Expected,
    processes: Iterable[ExecuteLocal],
    output_filter: Callable[[str], str] | None,
    *,
    strips: bool,
    descriptor: int,
) -> None:
    if output_filter is not None and not callable(output_filter):
        raise ValueError("output_filter is not callable")
    names: list[str] = []
    for process in processes:
        text = b"".join(each.text for each in proc_output[process] if each.fd == descriptor).decode()
        shown = _ESCAPE.sub("", text) if strips else text
        if contains(shown if output_filter is None else output_filter(shown), expected):
            return
        names.append((process.process_details or {"name": ""})["name"])
    raise AssertionError(
        f"Did not find '{expected}' in output for any of the matching processes: {', '.join(sorted(names))}"
    )


def contains(text: str, expected: Expected) -> bool:
    """Whether a text has what is expected. Raises ValueError for an expectation that is none."""
    whole = text.replace(os.linesep, "\n")
    if isinstance(expected, str):
        return expected in whole
    if isinstance(expected, re.Pattern):
        return expected.search(whole) is not None
    if not expected or not isinstance(expected, Sequence):  # pyright: ignore[reportUnnecessaryIsInstance]  # of users
        raise ValueError("Unknown format for expected output")
    if all(isinstance(each, str) for each in expected):
        lines = iter(whole.splitlines())
        return all(any(each == line for line in lines) for each in expected)
    at = 0
    for each in expected:
        found = re.compile(re.escape(each) if isinstance(each, str) else each).search(whole, at)
        if found is None:
            return False
        at = found.end()
    return True


def assertExitCodes(
    proc_info: ProcInfoHandler,
    allowable_exit_codes: Iterable[int] = (EXIT_OK,),
    process: ExecuteLocal | str | None = None,
    cmd_args: str | Sequence[str] | None = None,
    *,
    strict_proc_matching: bool = True,
) -> None:
    """Assert that a process, or each, has ended with one of these codes."""
    allowed = list(allowable_exit_codes)
    for each in resolveProcesses(
        proc_info, process=process, cmd_args=cmd_args, strict_proc_matching=strict_proc_matching
    ):
        info = proc_info[each]
        assert info.returncode in allowed, f"Proc {info.process_name} exited with code {info.returncode}"


class SequentialTextChecker:
    """Finds texts in a text, each after the one before."""

    def __init__(self, text_to_check: str) -> None:
        self._text = text_to_check
        self._at = 0

    def assertInText(self, msg: Pattern) -> bool:
        """Assert that a text or a pattern follows."""
        found = re.compile(re.escape(msg) if isinstance(msg, str) else msg).search(self._text, self._at)
        assert found is not None, f"'{msg}' does not follow in the output"
        self._at = found.end()
        return True

    assertInStdout = assertInText


@contextmanager
def assertSequentialStdout(
    proc_output: IoHandler, process: ExecuteLocal | str, cmd_args: str | Sequence[str] | None = None
) -> Generator[SequentialTextChecker]:
    """Yield a checker of the stdout of one process."""
    (found,) = resolveProcesses(proc_output, process=process, cmd_args=cmd_args)
    events: Any = proc_output[found]
    yield SequentialTextChecker(b"".join(each.text for each in events if each.from_stdout).decode())

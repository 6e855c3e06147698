"""Processes that tests start and end themselves, and expectations about their output."""

from __future__ import annotations

import re
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import contextmanager

from launch import LaunchDescription, LaunchService
from launch.actions import ExecuteLocal
from launch.events import matches_action
from launch.events.process import ProcessExited, ShutdownProcess

from launch_testing.asserts import Expected, Pattern, contains
from launch_testing.io_handler import ActiveIoHandler
from launch_testing.proc_info_handler import ActiveProcInfoHandler

__all__ = ["ProcessProxy", "basic_output_filter", "expect_output", "launch_process"]


class ProcessProxy:
    """A process that a test has started."""

    def __init__(
        self, process_action: ExecuteLocal, proc_info: ActiveProcInfoHandler, proc_output: ActiveIoHandler
    ) -> None:
        self._action = process_action
        self._info = proc_info
        self._output = proc_output

    @property
    def terminated(self) -> bool:
        """Whether it has ended."""
        return self._action in self._info.processes() and isinstance(self._info[self._action], ProcessExited)

    @property
    def exit_code(self) -> int:
        """The exit code of a process that has ended."""
        code: int = self._info[self._action].returncode
        return code

    @property
    def output(self) -> str:
        """The whole output so far."""
        return self._text(None)

    @property
    def stdout(self) -> str:
        """The output to stdout so far."""
        return self._text(1)

    @property
    def stderr(self) -> str:
        """The output to stderr so far."""
        return self._text(2)

    def _text(self, descriptor: int | None) -> str:
        events = [each for each in self._output if each.action is self._action]
        return b"".join(each.text for each in events if descriptor in {None, each.fd}).decode()

    def wait_for_shutdown(self, timeout: float | None = None) -> bool:
        """Wait up to `timeout` [s] for its end, and return whether it has ended."""
        with self._info.proc_event:
            return self._info.proc_event.wait_for(lambda: self.terminated, timeout)

    def wait_for_output(
        self, condition: Callable[[str], bool] | Pattern | None = None, timeout: float = 10
    ) -> bool:
        """Wait up to `timeout` [s] until its output fulfils a condition, and return whether it does."""
        if not callable(condition):
            expected: Pattern = "" if condition is None else condition
            return self._output.wait_until(lambda: contains(self.output, expected), timeout)
        return self._output.wait_until(lambda: condition(self.output), timeout)


@contextmanager
def launch_process(
    launch_service: LaunchService,
    process_action: ExecuteLocal,
    proc_info: ActiveProcInfoHandler,
    proc_output: ActiveIoHandler,
) -> Generator[ProcessProxy]:
    """Start a process in a launch that runs, and end it after the block."""
    proxy = ProcessProxy(process_action, proc_info, proc_output)
    launch_service.include_launch_description(LaunchDescription([process_action]))
    proc_info.assertWaitForStartup(process_action)
    try:
        yield proxy
    finally:
        if not proxy.terminated:
            event = ShutdownProcess(process_matcher=matches_action(process_action))
            launch_service.emit_event(event)
            proxy.wait_for_shutdown(20)


def basic_output_filter(
    filtered_prefixes: Sequence[str] = (),
    filtered_patterns: Iterable[str] = (),
    filtered_rmw_implementation: str | None = None,
) -> Callable[[str], str]:
    """Return a function that removes lines with these prefixes, and lines that match these patterns."""
    patterns = [re.compile(pattern) for pattern in filtered_patterns]

    def keep(line: str) -> bool:
        return not (line.startswith(tuple(filtered_prefixes)) or any(p.match(line) for p in patterns))

    return lambda output: "".join(line for line in output.splitlines(keepends=True) if keep(line))


def expect_output(
    *,
    expected_text: Pattern | None = None,
    expected_lines: Sequence[Pattern | None] | None = None,
    text: str | None = None,
    lines: Sequence[str] | None = None,
    strict: bool = False,
) -> bool:
    """Return whether a text, or its lines, has what is expected; with `strict` nothing else.

    Raises ValueError unless there is one expectation, and one text.
    """
    if (text is None) is (lines is None) or (expected_text is None) is (expected_lines is None):
        raise ValueError(
            "expect_output wants either text or lines, and either expected_text or expected_lines"
        )
    whole = text if text is not None else "\n".join(lines or ())
    if expected_text is not None:
        expected: Expected = expected_text
        if not strict:
            return contains(whole, expected)
        return bool(re.fullmatch(_pattern(expected_text), whole))
    wanted = list(expected_lines or ())
    given = whole.splitlines()
    starts = [0] if strict else range(len(given) - len(wanted) + 1)
    fits = [all(map(_is_line, wanted, given[at : at + len(wanted)])) for at in starts]
    return any(fits) and (not strict or len(wanted) == len(given))


def _is_line(expected: Pattern | None, line: str) -> bool:
    return expected is None or re.fullmatch(_pattern(expected), line) is not None


def _pattern(expected: Pattern) -> re.Pattern[str]:
    return re.compile(re.escape(expected)) if isinstance(expected, str) else expected

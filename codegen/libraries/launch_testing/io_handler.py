"""The output of processes, as tests see it while they run and afterwards."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence

from launch.actions import ExecuteLocal
from launch.events.process import ProcessIO

from launch_testing.asserts import Expected, assertInStderr, assertInStdout
from launch_testing.util import NoMatchingProcessException, resolveProcesses

__all__ = ["ActiveIoHandler", "IoHandler"]


class IoHandler:
    """The output of processes, in its order."""

    def __init__(self) -> None:
        self._events: list[ProcessIO] = []

    def append(self, process_io: ProcessIO) -> None:
        """Add an event."""
        self._events.append(process_io)

    def __iter__(self) -> Iterator[ProcessIO]:
        """Return all events in their order."""
        return iter(list(self._events))

    def processes(self) -> list[ExecuteLocal]:
        """Return the actions of the processes that have written something."""
        return list(dict.fromkeys(event.action for event in self._events))

    def process_names(self) -> list[str]:
        """Return their names."""
        return list(dict.fromkeys(event.process_name for event in self._events))

    def __getitem__(self, key: str | ExecuteLocal) -> list[ProcessIO]:
        """Return the events of a process, by its action or its whole name. Raises KeyError."""
        found = [
            e for e in self._events if (e.process_name == key if isinstance(key, str) else e.action is key)
        ]
        if not found:
            raise KeyError(key)
        return found


class ActiveIoHandler(IoHandler):
    """The same, while processes run: a test can wait for output."""

    def __init__(self) -> None:
        super().__init__()
        self._changed = threading.Condition()

    def append(self, process_io: ProcessIO) -> None:
        """Add an event."""
        with self._changed:
            super().append(process_io)
            self._changed.notify_all()

    def wait_until(self, condition: Callable[[], bool], timeout: float) -> bool:
        """Look at a condition after each event, up to `timeout` [s], and return whether it holds."""
        with self._changed:
            return self._changed.wait_for(condition, timeout)

    def waitFor(
        self,
        expected_output: Expected,
        process: ExecuteLocal | str | None = None,
        cmd_args: str | Sequence[str] | None = None,
        *,
        strict_proc_matching: bool = True,
        output_filter: Callable[[str], str] | None = None,
        timeout: float = 10,
        strip_ansi_escape_sequences: bool = True,
        stream: str = "stdout",
    ) -> bool:
        """Wait up to `timeout` [s] until a process has written something, and return whether it has."""
        check = assertInStderr if stream == "stderr" else assertInStdout

        def is_there() -> bool:
            try:
                check(
                    self,
                    expected_output,
                    process,
                    cmd_args,
                    output_filter=output_filter,
                    strict_proc_matching=strict_proc_matching,
                    strip_ansi_escape_sequences=strip_ansi_escape_sequences,
                )
            except (NoMatchingProcessException, AssertionError):
                return False
            return True

        found = self.wait_until(is_there, timeout)
        if not found:
            resolveProcesses(self, process=process, cmd_args=cmd_args, strict_proc_matching=False)
        return found

    def assertWaitFor(
        self,
        expected_output: Expected,
        process: ExecuteLocal | str | None = None,
        cmd_args: str | Sequence[str] | None = None,
        *,
        strict_proc_matching: bool = True,
        output_filter: Callable[[str], str] | None = None,
        timeout: float = 10,
        strip_ansi_escape_sequences: bool = True,
        stream: str = "stdout",
    ) -> None:
        """Assert that `waitFor` finds it."""
        found = self.waitFor(
            expected_output,
            process,
            cmd_args,
            strict_proc_matching=strict_proc_matching,
            output_filter=output_filter,
            timeout=timeout,
            strip_ansi_escape_sequences=strip_ansi_escape_sequences,
            stream=stream,
        )
        assert found, "Waiting for output timed out"

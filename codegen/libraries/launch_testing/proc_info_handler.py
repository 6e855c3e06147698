"""The starts and the ends of processes, as tests see them while they run and afterwards."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from launch.actions import ExecuteLocal
from launch.events.process import ProcessExited

from launch_testing.util import NoMatchingProcessException, resolveProcesses

__all__ = ["ActiveProcInfoHandler", "ProcInfoHandler"]


class ProcInfoHandler:
    """The last event in the life of each process."""

    def __init__(self) -> None:
        self._events: dict[ExecuteLocal, Any] = {}

    def append(self, process_info: Any) -> None:
        """Add an event."""
        self._events[process_info.action] = process_info

    def __iter__(self) -> Iterator[Any]:
        """Return the events."""
        return iter(list(self._events.values()))

    def processes(self) -> list[ExecuteLocal]:
        """Return the actions of the processes."""
        return list(self._events)

    def process_names(self) -> list[str]:
        """Return their names."""
        return [event.process_name for event in self._events.values()]

    def __getitem__(self, key: str | ExecuteLocal) -> Any:
        """Return the last event of a process, by its action or a part of its name. Raises KeyError."""
        if not isinstance(key, str):
            return self._events[key]
        for event in self._events.values():
            if key in event.process_name:
                return event
        raise KeyError(key)


class ActiveProcInfoHandler(ProcInfoHandler):
    """The same, while processes run: a test can wait for their starts and ends."""

    def __init__(self) -> None:
        super().__init__()
        self._changed = threading.Condition()

    @property
    def proc_event(self) -> threading.Condition:
        """The condition that is notified of each event."""
        return self._changed

    def append(self, process_info: Any) -> None:
        """Add an event."""
        with self._changed:
            super().append(process_info)
            self._changed.notify_all()

    def assertWaitForStartup(
        self,
        process: ExecuteLocal | str,
        cmd_args: str | Sequence[str] | None = None,
        *,
        timeout: float = 10,
    ) -> None:
        """Assert that a process starts within `timeout` [s]."""
        found = self._wait(process, cmd_args, timeout, lambda event: True)
        assert found, f"Timed out waiting for process '{process}' to start"

    def assertWaitForShutdown(
        self,
        process: ExecuteLocal | str,
        cmd_args: str | Sequence[str] | None = None,
        *,
        timeout: float = 10,
    ) -> None:
        """Assert that a process ends within `timeout` [s]."""
        found = self._wait(process, cmd_args, timeout, lambda event: isinstance(event, ProcessExited))
        assert found, f"Timed out waiting for process '{process}' to finish"

    def _wait(
        self,
        process: ExecuteLocal | str,
        cmd_args: str | Sequence[str] | None,
        timeout: float,
        is_right: Callable[[Any], bool],
    ) -> bool:
        def is_there() -> bool:
            try:
                found = resolveProcesses(self, process=process, cmd_args=cmd_args)
            except NoMatchingProcessException:
                return False
            return is_right(self._events[found[0]])

        with self._changed:
            return self._changed.wait_for(is_there, timeout)

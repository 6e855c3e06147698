"""Events in the life of a process, and what can be done to it."""

from __future__ import annotations

import signal
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from launch.event import Event

if TYPE_CHECKING:
    from launch.actions import ExecuteProcess

__all__ = [
    "ProcessExited",
    "ProcessIO",
    "ProcessStarted",
    "ProcessStderr",
    "ProcessStdout",
    "RunningProcessEvent",
    "ShutdownProcess",
    "SignalProcess",
]


class RunningProcessEvent(Event):
    """Something that a process did."""

    name = "launch.events.process.RunningProcessEvent"

    def __init__(
        self,
        *,
        action: ExecuteProcess,
        name: str,
        cmd: Sequence[str],
        cwd: str | None,
        env: Mapping[str, str] | None,
        pid: int,
    ) -> None:
        self.action = action
        self.process_name = name
        self.cmd = list(cmd)
        self.cwd = cwd
        self.env = env
        self.pid = pid

    @property
    def execute_process_action(self) -> ExecuteProcess:
        """The action, under its older name."""
        return self.action


class ProcessStarted(RunningProcessEvent):
    """A process has started."""

    name = "launch.events.process.ProcessStarted"


class ProcessExited(RunningProcessEvent):
    """A process has ended; a negative code is that of a signal."""

    name = "launch.events.process.ProcessExited"

    def __init__(
        self,
        *,
        returncode: int,
        action: ExecuteProcess,
        name: str,
        cmd: Sequence[str],
        cwd: str | None,
        env: Mapping[str, str] | None,
        pid: int,
    ) -> None:
        super().__init__(action=action, name=name, cmd=cmd, cwd=cwd, env=env, pid=pid)
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A process has written something; `fd` is 1 for stdout and 2 for stderr."""

    name = "launch.events.process.ProcessIO"
    fd = 0

    def __init__(
        self,
        *,
        text: bytes,
        action: ExecuteProcess,
        name: str,
        cmd: Sequence[str],
        cwd: str | None,
        env: Mapping[str, str] | None,
        pid: int,
    ) -> None:
        super().__init__(action=action, name=name, cmd=cmd, cwd=cwd, env=env, pid=pid)
        self.text = text

    @property
    def from_stdout(self) -> bool:
        """Whether it came from stdout."""
        return self.fd == 1

    @property
    def from_stderr(self) -> bool:
        """Whether it came from stderr."""
        return self.fd == 2


class ProcessStdout(ProcessIO):
    """A process has written to stdout."""

    name = "launch.events.process.ProcessStdout"
    fd = 1


class ProcessStderr(ProcessIO):
    """A process has written to stderr."""

    name = "launch.events.process.ProcessStderr"
    fd = 2


class _Targeted(Event):
    def __init__(self, *, process_matcher: Callable[[ExecuteProcess], bool]) -> None:
        self.process_matcher = process_matcher


class ShutdownProcess(_Targeted):
    """Some processes are to end."""

    name = "launch.events.process.ShutdownProcess"


class SignalProcess(_Targeted):
    """Some processes get a signal: its number, or its name such as `SIGUSR1`."""

    name = "launch.events.process.SignalProcess"

    def __init__(
        self,
        *,
        signal_number: str | signal.Signals | int,
        process_matcher: Callable[[ExecuteProcess], bool],
    ) -> None:
        super().__init__(process_matcher=process_matcher)
        self.signal = (
            signal.Signals[signal_number] if isinstance(signal_number, str) else signal.Signals(signal_number)
        )

    @property
    def signal_name(self) -> str:
        """The name of the signal."""
        return self.signal.name

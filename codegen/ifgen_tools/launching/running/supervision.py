"""The life of a process as its action describes it: lines, events, restarts, and its end at a shutdown."""

from __future__ import annotations

import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from launch.actions import ExecuteProcess
from launch.events.process import ProcessExited, ProcessStarted, ProcessStderr, ProcessStdout
from launch.launch_context import ProcessToStart

from ifgen_tools.launching.errors import LaunchError
from ifgen_tools.launching.running.process import Process, words_of

if TYPE_CHECKING:
    from ifgen_tools.launching.running.host import LaunchHost
    from ifgen_tools.launching.running.loop import TimedCall

RUN: Final = (sys.executable, "-m", "ifgen", "run")
"""The beginning of the command of each program in Python."""
_LONGEST_LINE: Final = 1 << 16
_SIGKILL: Final = getattr(signal, "SIGKILL", 9)
_ASKED: Final = {-signal.SIGINT, 128 + signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGTERM}
"""Exit codes of programs that end because they were asked to."""


class Supervision:
    """One process after the other, as long as it is respawned."""

    def __init__(self, host: LaunchHost, actions: list[ExecuteProcess], plan: ProcessToStart) -> None:
        self._host = host
        self.actions = actions
        self.plan = plan
        self.is_stopping = False
        self.failure = 0
        """The exit code of a death that nobody asked for, or of a process that had to be killed; else 0."""
        self._process: Process | None = None
        self._rest = {1: b"", 2: b""}
        self._retries = 0
        self._timers: list[TimedCall] = []
        is_program = tuple(plan.command[:4]) == RUN and not plan.shell
        self._note = host.new_file("dismissed") if is_program else ""

    def start(self) -> None:
        """Start the process. Raises LaunchError."""
        plan = self.plan
        try:
            self._process = Process(plan, self._host.loop.post, self._on_output, self._on_end, self._note)
        except OSError as error:
            reason = error.strerror or str(error)
            message = (
                f"cannot start the process '{plan.name}': {reason}: '{error.filename or plan.command[0]}'"
            )
            raise LaunchError(message, self.actions[0].place) from None
        self._host.warden.watch(self._process)
        self._host.output.log("INFO", plan.name, f"process started with pid [{self._process.pid}]")
        for action in self.actions:
            action.process_details = self._details(action)
            self._host.emit(ProcessStarted(**action.process_details))

    def signal(self, number: int) -> None:
        """Send a signal to the process, if it runs."""
        if self._process is not None:
            self._process.signal(number)

    def stop(self, *, quietly: bool) -> None:
        """Ask the process to end, and do more when its time is over."""
        if self.is_stopping:
            return
        self.is_stopping = True
        for timer in self._timers:  # of a restart
            timer.cancel()
        if self._process is None:
            self._host.ended(self)
            return
        plan = self.plan
        if not quietly:
            self._host.output.log("INFO", plan.name, f"sending signal 'SIGINT' to process[{plan.name}]")
        if self._note:
            Path(self._note).touch()
        self._process.signal(signal.SIGINT)
        self._escalate(plan.sigterm_timeout, plan.sigterm_timeout, "SIGINT", "SIGTERM", signal.SIGTERM)
        both = plan.sigterm_timeout + plan.sigkill_timeout
        self._escalate(both, plan.sigkill_timeout, "SIGTERM", "SIGKILL", _SIGKILL)

    def _escalate(self, after: float, waited: float, before: str, then: str, number: int) -> None:
        def send() -> None:
            name = self.plan.name
            text = f"process[{name}] failed to terminate '{waited:g}' seconds after receiving '{before}'"
            self._host.output.log("ERROR", name, f"{text}, escalating to '{then}'")
            self.signal(number)

        self._timers.append(self._host.loop.later(after, send, until_shutdown=False))

    def _details(self, action: ExecuteProcess) -> dict[str, Any]:
        plan = self.plan
        pid = 0 if self._process is None else self._process.pid
        return {
            "action": action,
            "name": plan.name,
            "cmd": list(plan.command),
            "cwd": plan.cwd,
            "env": plan.env,
            "pid": pid,
        }

    def _on_output(self, number: int, data: bytes) -> None:
        kind = ProcessStdout if number == 1 else ProcessStderr
        for action in self.actions:
            event = kind(text=data, **self._details(action))
            if self._host.context.would_handle_event(event):
                self._host.handle(event)
        *lines, rest = (self._rest[number] + data).split(b"\n")
        for line in lines:
            self._print(number, line)
        if len(rest) > _LONGEST_LINE:
            self._print(number, rest)
            rest = b""
        self._rest[number] = rest

    def _print(self, number: int, line: bytes) -> None:
        places = self.plan.stdout if number == 1 else self.plan.stderr
        text = line.removesuffix(b"\r").decode(errors="replace")
        self._host.output.line(self.plan.name, text, places, "stdout" if number == 1 else "stderr")

    def _on_end(self, code: int) -> None:
        process, self._process = self._process, None
        assert process is not None, "a process ends once"
        for timer in self._timers:
            timer.cancel()
        for number, rest in self._rest.items():
            if rest:
                self._print(number, rest)
                self._rest[number] = b""
        process.signal(_SIGKILL)  # what it has left behind in its group
        self._host.warden.forget(process)
        respawns = self._respawns()
        self._say(process.pid, code)
        if code and not respawns and (not self.is_stopping or code == -_SIGKILL):
            self.failure = code if code > 0 else 128 - code
        for action in self.actions:
            action.return_code = code
            details: dict[str, Any] = {**self._details(action), "pid": process.pid}
            self._host.handle(ProcessExited(returncode=code, **details))
        if respawns and not self.is_stopping:
            self._retries += 1
            self._timers.append(
                self._host.loop.later(self.plan.respawn_delay, self._restart, until_shutdown=True)
            )
            return
        for action in self.actions:
            self._host.completed(action)
        self._host.ended(self)

    def _respawns(self) -> bool:
        plan = self.plan
        wanted = plan.respawn and not self.is_stopping and not self._host.context.is_shutdown
        return wanted and (plan.respawn_max_retries < 0 or self._retries < plan.respawn_max_retries)

    def _restart(self) -> None:
        if not self.is_stopping:
            self.start()

    def _say(self, pid: int, code: int) -> None:
        log, name = self._host.output.log, self.plan.name
        if code == 0:
            log("INFO", name, f"process has finished cleanly [pid {pid}]")
        elif self.is_stopping and code in _ASKED:
            log("INFO", name, f"process has ended as it was asked to [pid {pid}]")
        else:
            command = words_of(self.plan.command)
            log("ERROR", name, f"process has died [pid {pid}, exit code {code}, cmd '{command}'].")

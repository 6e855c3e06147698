"""The processes of a launch: their starts, their lines, their events, and their ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from launch._errors import LaunchError
from launch.events.process import ProcessExited, ProcessStarted, ProcessStderr, ProcessStdout
from launch.launch_context import LaunchContext, ProcessToStart, Start, Timer
from launch.logging import get_logger, get_output_loggers

if TYPE_CHECKING:
    from launch.actions import ExecuteLocal

_CHUNK: Final = 65536
_MAX_WAITING: Final = 64
"""Chunks that wait to be printed; a process that writes more waits in turn."""

HAS_GROUPS: Final = hasattr(os, "killpg")
_LONGEST_LINE: Final = 1 << 16
_SIGKILL: Final = getattr(signal, "SIGKILL", 9)
_ASKED: Final = {-signal.SIGINT, 128 + signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGTERM}
"""Exit codes of programs that end because they were asked to."""


class Process:
    """A process that runs. It has a group of its own, which all signals go to.

    `post` makes calls in the thread of the launch: `on_output` with the number of the stream and bytes,
    `on_end` with the exit code, after all output, once.
    """

    def __init__(
        self,
        plan: ProcessToStart,
        post: Callable[[Callable[[], None]], None],
        on_output: Callable[[int, bytes], None],
        on_end: Callable[[int], None],
        start: Start | None,
    ) -> None:
        """Start it. Raises OSError."""
        self._post = post
        self._on_output = on_output
        self._room = threading.Semaphore(_MAX_WAITING)
        masters, pipes = _terminals() if plan.emulate_tty else ([], [subprocess.PIPE, subprocess.PIPE])
        try:
            # Unbuffered: the lines of Python programs come when they are printed.
            with nullcontext() if start is None else start.during:
                self._popen = subprocess.Popen(
                    " ".join(plan.command) if plan.shell else list(plan.command),
                    stdin=subprocess.PIPE,
                    stdout=pipes[0],
                    stderr=pipes[1],
                    cwd=plan.cwd,
                    env={"PYTHONUNBUFFERED": "1", **plan.env, **({} if start is None else start.environment)},
                    shell=plan.shell,
                    start_new_session=True,
                )
        except BaseException:
            for master in masters:
                os.close(master)
            raise
        finally:
            if plan.emulate_tty:
                for pipe in pipes:
                    os.close(pipe)
        streams = masters or [self._popen.stdout.fileno(), self._popen.stderr.fileno()]  # type: ignore[union-attr]  # both are pipes
        self.pid = self._popen.pid
        self._readers = [
            threading.Thread(target=self._read, args=(number, stream), daemon=True)
            for number, stream in enumerate(streams, 1)
        ]
        self._masters = masters
        self._waiter = threading.Thread(target=self._wait, args=(on_end,), daemon=True)

    def begin(self) -> None:
        """Let its output and its end come, now that its start is announced."""
        for thread in (*self._readers, self._waiter):
            thread.start()

    def signal(self, number: int) -> None:
        """Send a signal to it and to what it has started."""
        with suppress(OSError):
            if HAS_GROUPS:
                os.killpg(self.pid, number)
            elif number == _SIGKILL:
                self._popen.kill()
            else:
                self._popen.terminate()

    def _read(self, number: int, stream: int) -> None:
        while True:
            try:
                data = os.read(stream, _CHUNK)
            except OSError:  # the other end of a terminal is closed
                data = b""
            if not data:
                return
            self._room.acquire()
            self._post(lambda data=data: self._take(number, data))  # type: ignore[misc]  # bound now

    def _take(self, number: int, data: bytes) -> None:
        self._room.release()
        self._on_output(number, data)

    def _wait(self, on_end: Callable[[int], None]) -> None:
        code = self._popen.wait()
        for reader in self._readers:
            reader.join(1.0)  # longer only if something that it started keeps the pipe open
        for master in self._masters:
            os.close(master)
        pipes = (self._popen.stdin, self._popen.stdout, self._popen.stderr)
        for pipe in () if any(reader.is_alive() for reader in self._readers) else pipes:
            if pipe is not None:
                with suppress(OSError):
                    pipe.close()
        self._post(lambda: on_end(code))


def _terminals() -> tuple[list[int], list[int]]:
    """Two terminals, for stdout and stderr: our ends, and those of the process."""
    import pty  # there is none on Windows

    pairs = [pty.openpty() for _ in range(2)]
    return [master for master, _ in pairs], [slave for _, slave in pairs]


class Watchdog:
    """Ends the groups of processes if this process is killed (_watchdog.py)."""

    def __init__(self) -> None:
        self._popen: subprocess.Popen[bytes] | None = None

    def watch(self, process: Process) -> None:
        """End this group, too."""
        if HAS_GROUPS and self._popen is None:
            program = str(Path(__file__).parent / "_watchdog.py")
            self._popen = subprocess.Popen(
                [sys.executable, "-I", "-S", program], stdin=subprocess.PIPE, start_new_session=True
            )
        self._tell(f"+{process.pid}\n")

    def forget(self, process: Process) -> None:
        """Leave this group alone: it has ended."""
        self._tell(f"-{process.pid}\n")

    def close(self) -> None:
        """End what is left, and wait for that."""
        if self._popen is not None and self._popen.stdin is not None:
            with suppress(OSError):
                self._popen.stdin.close()
            self._popen.wait()

    def _tell(self, line: str) -> None:
        if self._popen is not None and self._popen.stdin is not None:
            with suppress(OSError):
                self._popen.stdin.write(line.encode())
                self._popen.stdin.flush()


class Supervision:
    """One process after the other, as long as it is respawned."""

    def __init__(
        self,
        context: LaunchContext,
        actions: Sequence[ExecuteLocal],
        plan: ProcessToStart,
        watchdog: Watchdog,
        on_end: Callable[[Supervision], None],
    ) -> None:
        self._context = context
        self._host = context.host
        self._watchdog = watchdog
        self._ended = on_end
        self.actions = actions
        self.plan = plan
        self._log = get_logger(plan.name)
        output = {"stdout": plan.stdout, "stderr": plan.stderr}
        self._printers = (get_logger(), *get_output_loggers(plan.name, output))
        self.is_stopping = False
        self.failure = 0
        """The exit code of a death that nobody asked for, or of a process that had to be killed; else 0."""
        self._process: Process | None = None
        self._rest = {1: b"", 2: b""}
        self._retries = 0
        self._timers: list[Timer] = []
        self._start: Start | None = None

    def start(self) -> None:
        """Start the process. Raises LaunchError."""
        plan = self.plan
        self._start = None if plan.shell else self._context.packages.start(plan.command, self._context.files)
        try:
            self._process = Process(plan, self._host.post, self._on_output, self._on_end, self._start)
        except OSError as error:
            reason = error.strerror or str(error)
            message = (
                f"cannot start the process '{plan.name}': {reason}: '{error.filename or plan.command[0]}'"
            )
            raise LaunchError(message, self.actions[0].place) from None
        self._watchdog.watch(self._process)
        self._log.info(f"process started with pid [{self._process.pid}]")
        for action in self.actions:
            action.process_details = self._details(action)
            self._host.emit(ProcessStarted(**action.process_details))
        self._process.begin()

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
            self._ended(self)
            return
        plan = self.plan
        if not quietly:
            self._log.info(f"sending signal 'SIGINT' to process[{plan.name}]")
        if self._start is not None:
            self._start.dismiss()
        self._process.signal(signal.SIGINT)
        self._escalate(plan.sigterm_timeout, plan.sigterm_timeout, "SIGINT", "SIGTERM", signal.SIGTERM)
        both = plan.sigterm_timeout + plan.sigkill_timeout
        self._escalate(both, plan.sigkill_timeout, "SIGTERM", "SIGKILL", _SIGKILL)

    def _escalate(self, after: float, waited: float, before: str, then: str, number: int) -> None:
        def send() -> None:
            name = self.plan.name
            text = f"process[{name}] failed to terminate '{waited:g}' seconds after receiving '{before}'"
            self._log.error(f"{text}, escalating to '{then}'")
            self.signal(number)

        self._timers.append(self._host.later(after, send, until_shutdown=False))

    def _details(self, action: ExecuteLocal) -> dict[str, Any]:
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
            if self._context.would_handle_event(event):
                self._host.handle(event)
        *lines, rest = (self._rest[number] + data).split(b"\n")
        for line in lines:
            self._print(number, line)
        if len(rest) > _LONGEST_LINE:
            self._print(number, rest)
            rest = b""
        self._rest[number] = rest

    def _print(self, number: int, line: bytes) -> None:
        self._printers[number].info("%s", line.removesuffix(b"\r").decode(errors="replace"))

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
        self._watchdog.forget(process)
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
            self._timers.append(self._host.later(self.plan.respawn_delay, self._restart, until_shutdown=True))
            return
        for action in self.actions:
            action.note_completion()
            self._host.completed(action)
        self._ended(self)

    def _respawns(self) -> bool:
        plan = self.plan
        wanted = plan.respawn and not self.is_stopping and not self._context.is_shutdown
        return wanted and (plan.respawn_max_retries < 0 or self._retries < plan.respawn_max_retries)

    def _restart(self) -> None:
        if not self.is_stopping:
            self.start()

    def _say(self, pid: int, code: int) -> None:
        if code == 0:
            self._log.info(f"process has finished cleanly [pid {pid}]")
        elif self.is_stopping and code in _ASKED:
            self._log.info(f"process has ended as it was asked to [pid {pid}]")
        else:
            command = " ".join(word for word in self.plan.command if word.strip())
            self._log.error(f"process has died [pid {pid}, exit code {code}, cmd '{command}'].")

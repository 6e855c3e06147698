"""A process of a launch: its start, its lines, its end, and the signals in between."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import Any, Final

from launch.launch_context import ProcessToStart

from ifgen_tools.running import processes

_CHUNK: Final = 65536
_MAX_WAITING: Final = 64
"""Chunks that wait to be printed; a process that writes more waits in turn."""

HAS_GROUPS: Final = hasattr(os, "killpg")


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
        note: str = "",
    ) -> None:
        """Start it. Raises OSError.

        :param note: of a program of `ifgen run`: a file that will be there once nothing is to be said of an
            interruption any more.
        """
        self._post = post
        self._on_output = on_output
        self._room = threading.Semaphore(_MAX_WAITING)
        masters, pipes = _terminals() if plan.emulate_tty else ([], [subprocess.PIPE, subprocess.PIPE])
        try:
            # Unbuffered: the lines of Python programs come when they are printed.
            with processes.signals_wait() if note else nullcontext():
                self._popen = subprocess.Popen(
                    " ".join(plan.command) if plan.shell else list(plan.command),
                    stdin=subprocess.PIPE,
                    stdout=pipes[0],
                    stderr=pipes[1],
                    cwd=plan.cwd,
                    env={"PYTHONUNBUFFERED": "1", **plan.env, **({processes.NOTE: note} if note else {})},
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
        for reader in self._readers:
            reader.start()
        threading.Thread(target=self._wait, args=(on_end,), daemon=True).start()

    def signal(self, number: int) -> None:
        """Send a signal to it and to what it has started."""
        with suppress(OSError):
            if HAS_GROUPS:
                os.killpg(self.pid, number)
            elif number == getattr(signal, "SIGKILL", 9):
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
        self._post(lambda: on_end(code))


def _terminals() -> tuple[list[int], list[int]]:
    """Two terminals, for stdout and stderr: our ends, and those of the process."""
    import pty  # there is none on Windows

    pairs = [pty.openpty() for _ in range(2)]
    return [master for master, _ in pairs], [slave for _, slave in pairs]


class Warden:
    """Ends the groups of processes if this process is killed (warden.py)."""

    def __init__(self) -> None:
        self._popen: subprocess.Popen[bytes] | None = None

    def watch(self, process: Process) -> None:
        """End this group, too."""
        if HAS_GROUPS and self._popen is None:
            program = str(Path(__file__).parent / "warden.py")
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


def words_of(command: Any) -> str:
    """Return a command for people."""
    return " ".join(str(word) for word in command if str(word).strip())

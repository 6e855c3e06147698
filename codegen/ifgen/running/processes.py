"""Runs each of several programs in a process: `ifgen run server.py : client.py 41 1`."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Literal

from ifgen.diagnostics import UsageError
from ifgen.running.ending import INTERRUPTED, PATIENCE

_STEP = 0.2  # [s]
_CHOOSE_PLACE = (
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ZENOH_SESSION_CONFIG_URI",
    "ZENOH_CONFIG_OVERRIDE",
)
"""The environment variables by which a user decides where programs meet."""
NOTE = "IFGEN_DISMISSED"
"""The environment variable that names a file, which exists once ifgen itself interrupts the program."""
NextSignal = Callable[[float], tuple[int, bool] | None]
"""Waits for a signal for the given seconds. Returns its number, and True if the terminal sent it to all."""

_FROM_TERMINAL = 0x80  # SI_KERNEL: Linux says so of Ctrl-C, which the terminal sends to every process


def take_note() -> Path | None:
    """Return where a file is once the last of several programs has ended; None: this one is alone."""
    note = os.environ.pop(NOTE, None)
    return None if note is None else Path(note)


def let_signals_come() -> None:
    """Let signals come, which wait while one of several programs starts."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGCHLD})


@contextmanager
def signals_wait() -> Generator[None]:
    """Start programs in this block whose signals wait until they call `let_signals_come`.

    Python, interrupted while it starts, would tell of what it was just importing.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def run(programs: Sequence[tuple[str, Sequence[str]]], transport: Literal["local", "rclpy"]) -> int:
    """Run programs, each a name and words of `ifgen run`, until the last one ends.

    Returns the worst of their exit codes.
    """
    command = [sys.executable, "-m", "ifgen", "run", "--transport", transport]
    with tempfile.TemporaryDirectory(prefix="ifgen-run-") as folder, meeting_place(transport) as place:
        note = Path(folder) / "dismissed"
        environment = {**os.environ, **place, NOTE: str(note)}
        with _signals() as next_signal:
            processes = [subprocess.Popen([*command, *words], env=environment) for _, words in programs]
            dismissed = _wait(processes, note, next_signal)
        return max(
            _code(process, name, dismissed=process in dismissed)
            for process, (name, _) in zip(processes, programs, strict=True)
        )


@contextmanager
def meeting_place(transport: Literal["local", "rclpy"]) -> Generator[dict[str, str]]:
    """Keep a router as long as programs run that cannot find each other otherwise; yields their variables."""
    chosen = any(os.environ.get(name) for name in _CHOOSE_PLACE)
    if transport == "rclpy" or chosen or _has_unix_sockets():
        yield {}
        return
    from ifgen.running.router import open_router  # late: most systems need none

    try:
        endpoint = f"tcp/127.0.0.1:{_free_port()}"
        router = open_router(listen=[endpoint])
    except UsageError:  # no Zenoh: the programs say so
        yield {}
        return
    try:
        yield {"ROS_STATIC_PEERS": endpoint}
    finally:
        router.close()


def _has_unix_sockets() -> bool:
    return hasattr(socket, "AF_UNIX")


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def _wait(
    processes: Sequence[subprocess.Popen[bytes]], note: Path, next_signal: NextSignal
) -> list[subprocess.Popen[bytes]]:
    """Wait for the last process; then dismiss the others, and wait for those for a while. Returns these."""
    dismissed: list[subprocess.Popen[bytes]] = []
    asked = 0  # how many signals came that end programs
    while processes[-1].poll() is None and not asked:
        asked += _pass_on(next_signal(_STEP), processes)
    if not asked:
        dismissed = _running(processes)
        note.touch()
        _pass_on((signal.SIGINT, False), dismissed)
    end = time.monotonic() + PATIENCE
    while asked < 2 and _running(processes) and (left := end - time.monotonic()) > 0:
        asked += _pass_on(next_signal(min(left, _STEP)), processes)
    return dismissed


def _running(processes: Sequence[subprocess.Popen[bytes]]) -> list[subprocess.Popen[bytes]]:
    return [process for process in processes if process.poll() is None]


def _pass_on(came: tuple[int, bool] | None, processes: Sequence[subprocess.Popen[bytes]]) -> int:
    """Give a signal to processes that do not have it; returns how many signals that end programs came."""
    if came is None:
        return 0
    number, from_terminal = came
    if not from_terminal:
        for process in _running(processes):
            process.send_signal(number)
    return 1


@contextmanager
def _signals() -> Generator[NextSignal]:
    """Handle the signals that end programs.

    On most systems, a child that ends wakes a thread that waits for one.
    """
    if threading.current_thread() is not threading.main_thread():
        yield partial(_sleep, deque())
        return
    ending = {n for n in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(n) is not signal.SIG_IGN}
    if not hasattr(signal, "sigtimedwait"):  # on macOS and Windows
        came: deque[int] = deque()
        before = {number: signal.signal(number, lambda number, _: came.append(number)) for number in ending}
        try:
            yield partial(_sleep, came)
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
        return

    def wait(timeout: float) -> tuple[int, bool] | None:
        found = signal.sigtimedwait({*ending, signal.SIGCHLD}, timeout)
        if found is None or found.si_signo not in ending:
            return None
        return found.si_signo, found.si_code == _FROM_TERMINAL

    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {*ending, signal.SIGCHLD})
    try:
        yield wait
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _sleep(came: deque[int], timeout: float) -> tuple[int, bool] | None:
    """Wait where nobody says who sent a signal: what comes to a program in the foreground is a terminal's."""
    time.sleep(timeout)
    if not came:
        return None
    number = came.popleft()
    return number, number == signal.SIGINT and sys.stdin is not None and sys.stdin.isatty()


def _code(process: subprocess.Popen[bytes], name: str, *, dismissed: bool) -> int:
    code = process.poll()
    if code is None:
        late = f"{name} did not end within {PATIENCE:.0f} s after Ctrl-C; ending it"
        print(f"ifgen: {late}", file=sys.stderr)
        process.kill()
        process.wait()
        return 1
    code = 128 - code if code < 0 else code  # as shells count
    return 0 if dismissed and code == INTERRUPTED else code

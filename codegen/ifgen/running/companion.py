"""A program that shares its process with others, and which of them a thread works for."""

from __future__ import annotations

import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any

from ifgen.running.ending import IMPORTING
from ifgen.running.main_code import MainCode, raise_in_thread
from ifgen.running.program import Program

Handler = Callable[[int, Any], Any] | int | None
"""The type of handlers for `signal.signal`."""

_IMPORT_PATIENCE = 5.0  # [s] with an import that others share
_STEP = 0.01  # [s]


class Companion:
    """A program in company, with everything that it believes to have for itself.

    `ros` is what rclpy takes for process-wide (`rclpy.impl.program.Program`).
    """

    def __init__(self, program: Program, ros: Any) -> None:
        self.program = program
        self.ros = ros
        self.main = MainCode()
        self.main_thread: threading.Thread | None = None
        self.threads: set[threading.Thread] = set()
        """Those that live, `main_thread` not among them."""
        self.attributes: dict[tuple[Any, str], Any] = {}
        """Its values of attributes, by owner and name."""
        self.modules: set[str] = set()
        """The names of the modules that it has for itself."""
        self.handlers: dict[int, Handler] = {}
        """Handlers by signal number."""
        self.due: deque[tuple[Callable[[int, Any], Any], int]] = deque()
        """Handlers that have to be called, with the number of the signal."""
        self.handling = threading.Lock()
        """Held while another thread than the main one calls handlers."""
        self.wakeup = -1
        """The argument of `signal.set_wakeup_fd`."""
        self.at_exit: list[tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]] = []
        self.dismissed = False
        """Whether it was interrupted because the last program had ended."""
        self.hurry = threading.Event()
        """Set when it is not to wait for its threads any longer."""
        self.leaving = False
        """Whether the threads that are left are being ended."""
        self.ended = threading.Event()
        self.code: int | None = None
        """The exit code of `os._exit`, or of a signal without a handler, if one of these ended it."""

    def interrupt(self, error: BaseException, first: Callable[[], object] | None = None) -> None:
        """Raise this in its main code, and call `first` there just before.

        Where the main code has ended, wait no longer for its other threads.
        """
        if not self.main.interrupt(error, first):
            self.hurry.set()
            if first is not None:
                first()
        self.rouse()

    def may_stop(self, thread_id: int | None) -> bool:
        """Return whether a thread of it may stop where it is, for all that others know.

        It may not while it imports a module that they share: that would leave them half a module. Nor while
        Python's own part of an import runs, which may hold the lock of all imports.
        """
        frames = sys._current_frames()  # pyright: ignore[reportPrivateUsage]  # documented; debuggers need it
        frame = frames.get(thread_id or 0)
        if frame is not None and frame.f_code.co_filename in IMPORTING:
            return False
        while frame is not None:
            code = frame.f_code
            imports = code.co_name == "_find_and_load" and code.co_filename in IMPORTING
            if imports and frame.f_locals["name"] not in self.modules:
                return False
            frame = frame.f_back
        return True

    def wait_until_it_may_stop(self, thread_id: int | None) -> None:
        """Wait for that, up to a limit."""
        end = time.monotonic() + _IMPORT_PATIENCE
        while not self.may_stop(thread_id) and time.monotonic() < end:
            time.sleep(_STEP)

    def rouse(self) -> None:
        """Let its main thread look up from a wait in rclpy."""
        if self.main.thread_id is not None:
            self.ros.rouse(self.main.thread_id)

    def stop_threads(self) -> None:
        """Let the threads that are left end: Python would end them with the process."""
        self.leaving = True
        for thread in list(self.threads):
            if thread.ident is not None and thread.is_alive() and thread is not threading.current_thread():
                self.wait_until_it_may_stop(thread.ident)
                raise_in_thread(thread.ident, SystemExit())
                self.ros.rouse(thread.ident)

    def vanish(self, code: int) -> None:
        """End at once with this code, as a process can, without cleaning up."""
        self.code = code
        if threading.current_thread() is not self.main_thread:
            self.main.interrupt(SystemExit(code))
        self.leave()

    def leave(self) -> None:
        """Take everything away that others see of it."""
        self.stop_threads()
        self.ros.leave()
        self.ended.set()


_here = threading.local()


def current() -> Companion | None:
    """The program that this thread works for; None if it works for none."""
    companion: Companion | None = getattr(_here, "companion", None)
    return companion


def work_for(companion: Companion) -> None:
    """Let this thread work for a program as long as it lives."""
    _here.companion = companion


@contextmanager
def working_for(companion: Companion | None) -> Generator[None]:
    """Let this thread work for a program."""
    before, _here.companion = current(), companion
    try:
        yield
    finally:
        _here.companion = before

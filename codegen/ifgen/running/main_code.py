"""The main code of a program in company, in which other threads can raise exceptions, as signals do."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable

starting = threading.RLock()
"""Held while a thread starts: until it runs, Python knows it by the identifier of its starter."""

_raise_in_thread = ctypes.pythonapi.PyThreadState_SetAsyncExc


class MainCode:
    """Runs once, on the thread that is the program's main thread."""

    def __init__(self) -> None:
        self.ending: BaseException | None = None
        """The exception that ended it; None if it ran to its end."""
        self.thread_id: int | None = None
        self._gate = threading.RLock()
        self._early: BaseException | None = None
        self._interruption: BaseException | None = None

    def run(self, code: Callable[[], None]) -> None:
        """Run it and keep how it ended: whatever is raised from outside when it has ended is dropped."""
        with self._gate:
            self.thread_id = threading.get_ident()
        begun = ended = closed = False
        while not closed:
            try:
                if not begun:
                    begun = True
                    if self._early is not None:
                        raise self._early
                    code()
                    ended = True
                self._gate.acquire()  # for good, and perhaps twice: whoever interrupts finds it taken
                closed = True
            except BaseException as error:
                if not ended:
                    self.ending, ended = error, True
        _raise_in_thread(ctypes.c_ulong(self.thread_id), None)  # what has not come yet

    def interrupt(self, error: BaseException, first: Callable[[], object] | None = None) -> bool:
        """Raise this in it, soon, or as it begins; returns False if it is too late for that.

        `first` is called on its thread just before, unless the code has not begun.
        """
        if not self._gate.acquire(timeout=1.0):
            return False
        try:
            self._interruption = error
            if self.thread_id is None:
                self._early = error
            else:
                raise_in_thread(self.thread_id, error, first)
        finally:
            self._gate.release()
        return True

    def is_interrupted_by(self, error: BaseException | None) -> bool:
        """Return whether this is what `interrupt` was last asked to raise."""
        return error is not None and error is self._interruption


def raise_in_thread(thread_id: int, error: BaseException, first: Callable[[], object] | None = None) -> None:
    """Let a thread call `first` and raise this before its next step in Python.

    What it waits for in C takes its time.
    """

    # Python itself makes the exception, in that thread, by calling the given class.
    def make(*_: object) -> BaseException:
        if first is not None:
            first()
        return error

    kind = type(type(error).__name__, (type(error),), {"__new__": make})
    with starting:
        _raise_in_thread(ctypes.c_ulong(thread_id), ctypes.py_object(kind))

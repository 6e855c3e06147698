"""Lets each program in company end as a process does: with what it registered, or at once by `os._exit`."""

from __future__ import annotations

import _thread
import atexit
import inspect
import os
import sys
import traceback
import weakref
from collections.abc import Callable
from contextlib import ExitStack
from types import FrameType
from typing import Any, NoReturn

from ifgen.running.companion import Companion, current
from ifgen.running.ending import without_ours
from ifgen.running.exchange import exchanged


class OwnExits:
    """Does so while it is entered. What shared modules register stays with the process."""

    def __init__(self) -> None:
        self._process = os.getpid()
        self._register, self._unregister = atexit.register, atexit.unregister
        self.exit = os._exit
        """The process's own."""
        self._stack = ExitStack()

    def __enter__(self) -> OwnExits:
        weakref.finalize(self, int)  # registers what runs the finalizers of all programs at the process's end
        self._stack.enter_context(
            exchanged(
                (atexit, "register", self._register_here),
                (atexit, "unregister", self._unregister_here),
                (os, "_exit", self._exit_here),
            )
        )
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def run(self, companion: Companion) -> None:
        """Call what a program has registered, the last one first; what these raise is printed."""
        while companion.at_exit:
            function, positional, named = companion.at_exit.pop()
            try:
                function(*positional, **named)
            except BaseException as error:
                error.__traceback__ = without_ours(error.__traceback__)
                text = "".join(traceback.format_exception(error))
                place = f" {function!r}:" if sys.version_info >= (3, 13) else f": {function!r}"
                print(f"Exception ignored in atexit callback{place}\n{text}", end="", file=sys.stderr)

    def _register_here(
        self, function: Callable[..., Any], /, *positional: Any, **named: Any
    ) -> Callable[..., Any]:
        companion = current()
        if companion is None or not _is_own(companion, inspect.currentframe()):
            return self._register(function, *positional, **named)
        if not callable(function):
            raise TypeError("the first argument must be callable")
        companion.at_exit.append((function, positional, named))
        return function

    def _unregister_here(self, function: Callable[..., Any], /) -> None:
        companion = current()
        if companion is not None:
            companion.at_exit[:] = [each for each in companion.at_exit if each[0] != function]
        self._unregister(function)

    def _exit_here(self, status: int) -> NoReturn:
        companion = current()
        if companion is None or os.getpid() != self._process:
            self.exit(status)
        companion.vanish(status & 0xFF)
        never = _thread.allocate_lock()
        while True:  # the thread has nothing to do any more, and does not outlive the process
            never.acquire()


def _is_own(companion: Companion, frame: FrameType | None) -> bool:
    """Whether a function was called by a module that the program has for itself."""
    caller = frame and frame.f_back
    return caller is not None and caller.f_globals.get("__name__") in companion.modules

"""Threads of ours that use a transport, and that whoever closes it waits for."""

from __future__ import annotations

import _thread
import time
from collections.abc import Callable
from typing import Any, Final

_BETWEEN_LOOKS: Final = 0.001  # [s]


class Background:
    """Runs functions on threads until its end.

    A thread that is inside Zenoh while Python ends is torn out of it, and that aborts the process. It is
    enough that it lets go of the last reference to a session, so each lets go of its function before it
    counts as finished. Appending and popping are atomic.
    """

    def __init__(self) -> None:
        self._running: list[None] = []
        self._ending = (
            _thread.allocate_lock()
        )  # not threading's, which virtual time exchanges; free at the end
        self._ending.acquire()
        self._has_ended = False

    def start(self, function: Callable[..., object], *arguments: Any, delay: float = 0.0) -> None:
        """Call a function on a thread, after a delay [s]; not at all if the end comes first."""
        if not self._has_ended:
            self._running.append(None)
            # Not threading's: a program counts its own threads.
            _thread.start_new_thread(self._run, ([(function, arguments)], delay))

    def _run(self, work: list[tuple[Callable[..., object], tuple[Any, ...]]], delay: float) -> None:
        try:
            if delay and self._ending.acquire(timeout=delay):
                self._ending.release()
            if not self._has_ended:
                work[0][0](*work[0][1])
        finally:
            work.clear()
            self._running.pop()

    def end(self, patience: float) -> None:
        """Start nothing more, and wait for what runs, but at most this long [s]."""
        if not self._has_ended:
            self._has_ended = True
            self._ending.release()
        until = time.monotonic() + patience
        while self._running and time.monotonic() < until:
            time.sleep(_BETWEEN_LOOKS)

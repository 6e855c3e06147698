"""Ctrl-C and SIGTERM: a block ends at once (`..._raises`), or in its own time (`..._interrupt`).

What SIGTERM raises is Terminated, everywhere. Python handles signals in its main thread, so in another thread
these blocks change nothing.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Generator, Iterable
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Final

INTERRUPTED: Final = 130
"""The exit code of what Ctrl-C ended, as shells have it."""

TERMINATED: Final = 143
"""The exit code of what SIGTERM ended."""

_BOTH: Final = (signal.SIGINT, signal.SIGTERM)


class Terminated(KeyboardInterrupt):
    """SIGTERM came, from a supervisor or a CI job that is cancelled."""


@dataclass(slots=True)
class Interrupt:
    """The signals that came in a block: the number of the first, 0 while none has come, and the count."""

    number: int = 0
    count: int = 0

    def add(self, number: int) -> None:
        """Count a signal."""
        self.number = self.number or number
        self.count += 1

    def raise_again(self) -> None:
        """Raise what the first signal would have raised, if one came."""
        if self.number:
            raise _exception(self.number)


@contextmanager
def signal_handler(
    handler: Callable[[int, FrameType | None], object], numbers: Iterable[int]
) -> Generator[None]:
    """Call a function for signals in a block, and restore the handlers of before."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier or signal.SIG_DFL)  # None: not Python's own


@contextmanager
def sigterm_raises() -> Generator[None]:
    """Let SIGTERM raise Terminated, so that it is cleaned up like Ctrl-C."""

    def end(number: int, _: FrameType | None) -> None:
        raise _exception(number)

    with signal_handler(end, [signal.SIGTERM]):
        yield


@contextmanager
def signals_raise() -> Generator[Interrupt]:
    """Let Ctrl-C and SIGTERM end a block, and note which one came.

    Python may turn what they raise into another exception, such as the ImportError of a module in C. They are
    heard in the background of a script, too, where a shell lets programs ignore Ctrl-C: scripts end their
    programs by `kill -INT`, as they do with those of ROS.
    """
    interrupt = Interrupt()

    def end(number: int, _: FrameType | None) -> None:
        interrupt.add(number)
        sys.unraisablehook = _ignore_unraisable
        raise _exception(number)

    with signal_handler(end, _BOTH):
        yield interrupt


@contextmanager
def delay_interrupt(finished: str) -> Generator[None]:
    """Let Ctrl-C and SIGTERM wait until the end of a block; `finished` says then what had been done.

    A second one, of somebody who is impatient, is heard at once.
    """
    interrupt = Interrupt()
    with ExitStack() as handlers:

        def wait(number: int, _: FrameType | None) -> None:
            interrupt.add(number)
            handlers.close()

        handlers.enter_context(signal_handler(wait, _BOTH))
        yield
    if interrupt.number:
        try:
            signal.raise_signal(interrupt.number)
        except KeyboardInterrupt as stop:
            raise type(stop)(finished) from None


@contextmanager
def defer_interrupt(patience: int = 1) -> Generator[Interrupt]:
    """Count Ctrl-C and SIGTERM, and leave it to the block when to end: it calls `raise_again` after its work.

    `patience` signals are counted. The next one ends the block at once.
    """
    interrupt = Interrupt()

    def wait(number: int, _: FrameType | None) -> None:
        interrupt.add(number)
        if interrupt.count > patience:
            raise _exception(number)

    with signal_handler(wait, _BOTH):
        yield interrupt


def _exception(number: int) -> KeyboardInterrupt:
    return Terminated() if number == signal.SIGTERM else KeyboardInterrupt()


def _ignore_unraisable(_: object) -> None:
    """Say nothing of a finaliser that fails: the signal may have come while its object was half made.

    It stays until the process ends, which is now: the object goes with the traceback, whenever that is.
    """

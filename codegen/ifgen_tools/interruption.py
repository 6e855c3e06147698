"""Ctrl-C and SIGTERM: a tool ends wherever it is, or in its own time where its work must have an end."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType

from ifgen.writing.interruption import Terminated


@dataclass(slots=True)
class Heard:
    """The number of the signal that came, 0 while none has come."""

    number: int = 0


@contextmanager
def hearing() -> Generator[Heard]:
    """Let Ctrl-C and SIGTERM end a block, and note which one came.

    Python may turn what they raise into another exception, such as the ImportError of a module in C. They are
    heard in the background of a script, too, where a shell lets programs ignore Ctrl-C: scripts end their
    programs by `kill -INT`, as they do with those of ROS.
    """
    heard = Heard()
    if threading.current_thread() is not threading.main_thread():
        yield heard
        return

    def end(number: int, _: FrameType | None) -> None:
        heard.number = number
        sys.unraisablehook = _silent
        raise _stop(number)

    before = {number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield heard
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


def _silent(_: object) -> None:
    """Say nothing of a finaliser that fails: the signal may have come while its object was half made.

    It stays until the process ends, which is now: the object goes with the traceback, whenever that is.
    """


class Interruption:
    """Whether the user wants to stop, and by which signal."""

    def __init__(self) -> None:
        self._signal: int | None = None

    def __bool__(self) -> bool:
        return self._signal is not None

    def note(self, number: int, _: FrameType | None = None) -> None:
        """Note a signal. The second one stops at once."""
        if self._signal is not None:
            raise _stop(number)
        self._signal = number

    def stop(self) -> KeyboardInterrupt:
        """The exception to raise once the work has ended."""
        return _stop(self._signal or signal.SIGINT)


def _stop(number: int) -> KeyboardInterrupt:
    return Terminated() if number == signal.SIGTERM else KeyboardInterrupt()


@contextmanager
def noted() -> Generator[Interruption]:
    """Within the block, Ctrl-C and SIGTERM are noted; only a second one stops it."""
    interruption = Interruption()
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, interruption.note) for number in numbers]
    try:
        yield interruption
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)

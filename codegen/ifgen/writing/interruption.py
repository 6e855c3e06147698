"""Ctrl-C and SIGTERM: both end what ifgen does in the same way, but never in the middle of a change."""

from __future__ import annotations

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from types import FrameType
from typing import Final

INTERRUPTED: Final = 130
"""The exit code of what Ctrl-C ended, as shells have it."""

TERMINATED: Final = 143
"""The exit code of what SIGTERM ended."""

_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


class Terminated(KeyboardInterrupt):
    """SIGTERM came, from a supervisor or a CI job that is cancelled."""


@contextmanager
def terminable() -> Generator[None]:
    """Let SIGTERM raise Terminated, so that it is cleaned up like Ctrl-C."""
    if not _is_main_thread():
        yield
        return

    def end(_: int, __: FrameType | None) -> None:
        raise Terminated

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before or signal.SIG_DFL)


@contextmanager
def held(finished: str) -> Generator[None]:
    """Let Ctrl-C and SIGTERM wait until the end of a block; `finished` says then what had been done.

    A second one, of somebody who is impatient, is heard at once.
    """
    if not _is_main_thread():
        yield
        return
    came: list[int] = []

    def restore() -> None:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)  # None stands for one that is not Python's

    def note(number: int, _: FrameType | None) -> None:
        came.append(number)
        restore()

    before = {number: signal.signal(number, note) for number in _SIGNALS}
    try:
        yield
    finally:
        restore()
    if came:
        try:
            signal.raise_signal(came[0])
        except KeyboardInterrupt as stop:
            raise type(stop)(finished) from None


def _is_main_thread() -> bool:
    """Whether this is the thread in which Python handles signals."""
    return threading.current_thread() is threading.main_thread()

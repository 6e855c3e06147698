"""Signals that call functions within an event loop."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any, Self

__all__ = ["AsyncSafeSignalManager"]

_Handler = Callable[[signal.Signals], object]


class AsyncSafeSignalManager:
    """Calls the handlers of signals in a loop, during its `with` block, which may be entered again.

    Only the main thread can enter it. What handled the signals before does so again afterwards.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._handlers: dict[signal.Signals, _Handler] = {}
        self._before: dict[signal.Signals, Any] | None = None  # None outside of the block

    def handle(self, signum: signal.Signals | int, handler: _Handler | None) -> _Handler | None:
        """Call a handler with a signal, or None: no longer. Returns the one before."""
        number = signal.Signals(signum)
        before = self._handlers.pop(number, None)
        if handler is not None:
            self._handlers[number] = handler
            self._install(number)
        elif self._before is not None and number in self._before:
            signal.signal(number, self._before.pop(number))
        return before

    def __enter__(self) -> Self:
        self._before = {}
        for number in self._handlers:
            self._install(number)
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        before, self._before = self._before or {}, None
        for number, handler in before.items():
            signal.signal(number, handler)

    def _install(self, number: signal.Signals) -> None:
        if self._before is not None and number not in self._before:
            self._before[number] = signal.signal(number, self._come)

    def _come(self, number: int, _: FrameType | None) -> None:
        handler = self._handlers.get(signal.Signals(number))
        if handler is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(handler, signal.Signals(number))

"""Sources that an executor waits for, and their notifications.

An endpoint that gets data notifies its listeners. A listener only marks something as ready and wakes a
sleeper. User code never runs inside a listener, so nothing here can deadlock with it.
"""

from __future__ import annotations

from collections.abc import Callable

Listener = Callable[[], None]


class ReadySource:
    """Something that becomes ready: a subscription with a message, a client with a response, a timer.

    `is_ready()` answers now; `wake_at()` says when the source will become ready by itself.
    """

    __slots__ = ("_listeners",)

    def __init__(self) -> None:
        self._listeners: tuple[Listener, ...] = ()

    def is_ready(self) -> bool:
        """Whether there is something to take at this moment."""
        raise NotImplementedError

    def wake_at(self) -> int | None:
        """The steady time [ns] at which this may become ready by itself; None for never."""
        return None

    def is_timed(self) -> bool:
        """True if this may become ready by itself; else `wake_at` need not be asked."""
        return type(self).wake_at is not ReadySource.wake_at

    def add_listener(self, listener: Listener) -> None:
        """Call `listener`, on any thread, whenever this may have become ready or moved its `wake_at`."""
        self._listeners = (*self._listeners, listener)

    def remove_listener(self, listener: Listener) -> None:
        """Stop calling it; unknown listeners are ignored (a removal may race with a destruction)."""
        self._listeners = tuple(known for known in self._listeners if known != listener)

    def remove_listeners(self, unwanted: Callable[[Listener], bool]) -> None:
        """Remove the listeners for which this is true."""
        if any(unwanted(known) for known in self._listeners):
            self._listeners = tuple(known for known in self._listeners if not unwanted(known))

    def notify(self) -> None:
        """Tell every listener. The caller holds no lock."""
        for listener in self._listeners:
            listener()

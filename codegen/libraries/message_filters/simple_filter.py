"""The base of all filters: callbacks for what a filter passes on."""

from collections.abc import Callable
from typing import Any


class SimpleFilter:
    """Calls back with each message that a filter passes on. Derived classes say which those are."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, callback: Callable[..., Any], *args: Any) -> int:
        """Call a function with each output, and `args` after it. Returns a number to unregister it by."""
        # Upstream counts those that are there, so that one may take the place of another after a removal.
        connection = max(self.callbacks, default=-1) + 1
        self.callbacks[connection] = (callback, args)
        return connection

    def signalMessage(self, *msg: Any) -> None:
        """Call all callbacks, in the order in which they were registered."""
        for callback, args in tuple(self.callbacks.values()):
            callback(*msg, *args)

    def unregisterCallback(self, conn: int) -> None:
        """Forget a callback. One that is not registered is fine."""
        self.callbacks.pop(conn, None)

"""The base of all filters: callbacks for what a filter passes on."""

from collections.abc import Callable
from types import CoroutineType
from typing import Any


class SimpleFilter:
    """Calls back with each message that a filter passes on. Derived classes say which those are.

    The executor of the node whose messages these are runs callbacks that are coroutine functions, as tasks.
    """

    node: Any = None  # of filters that have one
    _source: "SimpleFilter | None" = None  # the filter whose output comes in; the last one of several

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:
        """Call a function with each output, and `args` after it. Returns a number to unregister it by."""
        receiver = getattr(cb, "__self__", None)
        if isinstance(receiver, SimpleFilter):
            receiver._source = self
        # Upstream counts those that are there, so that one may take the place of another after a removal.
        connection = max(self.callbacks, default=-1) + 1
        self.callbacks[connection] = (cb, args)
        return connection

    def signalMessage(self, *msg: Any) -> None:
        """Call all callbacks, in the order in which they were registered."""
        for callback, args in tuple(self.callbacks.values()):
            result = callback(*msg, *args)
            if isinstance(result, CoroutineType):
                self._run(callback, result)

    def _run(self, callback: Callable[..., Any], coroutine: Any) -> None:
        filter_: SimpleFilter | None = self
        while filter_ is not None and filter_.node is None:
            filter_ = filter_._source
        executor = None if filter_ is None else filter_.node.executor
        if executor is None:
            coroutine.close()
            name = getattr(callback, "__qualname__", repr(callback))
            raise RuntimeError(
                f"no executor can run the coroutine function {name}: the messages of its filter come from no "
                "message_filters.Subscriber whose node is in an executor"
            )
        executor.create_task(coroutine)

    def unregisterCallback(self, conn: int) -> None:
        """Forget a callback. One that is not registered is fine."""
        self.callbacks.pop(conn, None)

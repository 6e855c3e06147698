"""The common part of the handles of publishers, subscriptions, clients, services and events."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rmw_local.ready import Listener, ReadySource

from .destroyable import Destroyable
from .errors import RCLError
from .names import rclpy_get_validation_error_for_full_topic_name

if TYPE_CHECKING:
    from .node import Node

# In upstream's words, which differ.
_INVALID_NAME = {
    "publisher": "Failed to create {kind} due to invalid topic name '{name}'",
    "subscription": "Failed to create {kind} due to invalid topic name '{name}'",
    "client": "failed to create {kind} due to invalid service name '{name}': {reason}",
    "service": "failed to create {kind} due to invalid topic name '{name}': {reason}",
}


class EndpointHandle(Destroyable):
    """A handle whose endpoint leaves the graph when the handle is destroyed, or has become garbage."""

    _close: Callable[[], None] | None = None

    def _attach(self, node: Node, close: Callable[[], None]) -> None:
        """Keep what belongs to a living endpoint: its node, and how to close it."""
        self._node = node
        self._close = close

    def _bury(self) -> None:
        """Let counterparts that were collected as garbage leave first."""
        self._node.graph_node.participant.domain.bury()

    def get_logger_name(self) -> str:
        """Return the name of its node's logger."""
        return self._node.logger_name()

    def _on_destroy(self) -> None:
        if self._close is not None:
            self._close()

    def __del__(self) -> None:
        # A collector may run while this thread holds any lock: closing has to wait until somebody looks.
        if self._close is not None and not self._destroyed:
            self._node.graph_node.participant.domain.forsake(self._close)


class SourceHandle(Destroyable, ReadySource):
    """A handle that is ready when something of the middleware is: `_source`."""

    def __init__(self) -> None:
        Destroyable.__init__(self)
        ReadySource.__init__(self)
        self._source = ReadySource()

    def _use(self, source: ReadySource) -> None:
        """Be ready when `source` is."""
        self._source = source
        # One call less, at least twice a message.
        self.is_ready = source.is_ready  # type: ignore[method-assign]

    def is_ready(self) -> bool:
        """Whether there is something to take."""
        return self._source.is_ready()

    def wake_at(self) -> int | None:
        """The time at which it may become ready by itself [ns, steady]."""
        return self._source.wake_at()

    def is_timed(self) -> bool:
        """Whether it may become ready by itself."""
        return self._source.is_timed()

    def add_listener(self, listener: Listener) -> None:
        """Add a listener to the endpoint."""
        self._source.add_listener(listener)

    def remove_listener(self, listener: Listener) -> None:
        """Remove a listener from the endpoint."""
        self._source.remove_listener(listener)

    def remove_listeners(self, unwanted: Callable[[Listener], bool]) -> None:
        """Remove the listeners for which this is true."""
        self._source.remove_listeners(unwanted)


def resolve(node: object, name: str, kind: str, *, is_service: bool = False) -> tuple[Node, str]:
    """Return the node and an endpoint's full name.

    Raises ValueError for a bad name, TypeError for what is no node, RCLError in a context that is down.
    """
    from .node import Node  # late: nodes have publishers of their own (rosout)

    if not isinstance(node, Node):
        raise TypeError(f"failed to create {kind}: expected a node handle, got {node!r}")
    if not node.context.valid:
        raise RCLError(f"{'f' if is_service else 'F'}ailed to create {kind}: rcl node's context is invalid")
    try:
        full_name = node.resolve_name(name, is_service=is_service)
        fault = rclpy_get_validation_error_for_full_topic_name(full_name)
        if fault is None:
            return node, full_name
        reason = fault[0]
    except ValueError as error:
        reason = str(error)
    raise ValueError(_INVALID_NAME[kind].format(kind=kind, name=name, reason=reason))

"""The common part of the handles of publishers, subscriptions, clients, services and events."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeVar

from rmw_local.graph import GraphNode, TypeConflictError
from rmw_local.qos import QosProfile, unknown_policy
from rmw_local.ready import Listener, ReadySource

from rclpy.impl import distro

from .handle import Destroyable, RCLError
from .node import Node

# In upstream's words, which differ.
_FAILED = {"publisher": "Failed", "subscription": "Failed", "client": "failed", "service": "failed"}
_INVALID_NAME = {
    "publisher": "topic name '{name}'",
    "subscription": "topic name '{name}'",
    "client": "service name '{name}': {reason}",
    "service": "topic name '{name}': {reason}",
}
_E = TypeVar("_E")


class EndpointHandle(Destroyable):
    """A handle whose endpoint leaves the graph when the handle is destroyed, or has become garbage."""

    _close: Callable[[], None] | None = None

    def _open(
        self,
        kind: str,
        node: object,
        name: str,
        profile: QosProfile,
        create: Callable[[GraphNode, str], _E],
        close: Callable[[GraphNode, _E], None],
    ) -> _E:
        """Join the graph with an endpoint, which the handle closes at its end.

        Raises ValueError for a bad name, TypeError for what is no node, RCLError for anything else.
        """
        owner, full_name = _resolve(node, name, kind)
        failure = f"{_FAILED[kind]} to create {kind}"
        if policy := unknown_policy(profile):
            raise RCLError(f"{failure}: the {policy} policy is unknown")
        try:
            endpoint = create(owner.graph_node, full_name)
        except TypeConflictError as error:
            raise RCLError(f"{failure}: create_{kind}() called for {error}") from None
        self._node = owner
        self._close = partial(close, owner.graph_node, endpoint)
        return endpoint

    def _close_pending(self) -> None:
        """Let counterparts that were collected as garbage leave first."""
        self._node.graph_node.participant.domain.close_pending()

    def get_logger_name(self) -> str:
        """Return the name of its node's logger."""
        return self._node.logger_name()

    def _on_destroy(self) -> None:
        if self._close is not None:
            self._close()

    def __del__(self) -> None:
        # A collector may run while this thread holds any lock: closing has to wait until somebody looks.
        if self._close is not None and not self._destroyed:
            self._node.graph_node.participant.domain.close_later(self._close)


class SourceHandle(Destroyable, ReadySource):
    """A handle that is ready when something of the middleware is: `_source`."""

    def __init__(self) -> None:
        Destroyable.__init__(self)
        ReadySource.__init__(self)
        self._source = ReadySource()
        self._arrival_listener: Listener | None = None

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

    def _call_on_arrival(self, callback: Callable[[int], object] | None) -> None:
        """Call back with the number of things that have arrived: at once with those that wait already.

        Later calls are made by the thread that brings them. None ends it.
        """
        distro.uses("on_new_callbacks")
        if self._arrival_listener is not None:
            self._source.remove_listener(self._arrival_listener)
            self._arrival_listener = None
        if callback is None:
            return
        if not callable(callback):
            raise TypeError(f"expected a callback that takes a number, got {callback!r}")
        self._arrival_listener = partial(_call_with_one, callback)
        self._source.add_listener(self._arrival_listener)
        if waiting := self._count_waiting():
            callback(waiting)

    def _count_waiting(self) -> int:
        """The number of things that wait to be taken."""
        return int(self._source.is_ready())


def _call_with_one(callback: Callable[[int], object]) -> None:
    """Call back about one thing that has arrived."""
    callback(1)


def _resolve(node: object, name: str, kind: str) -> tuple[Node, str]:
    """Return the node and an endpoint's full name."""
    if not isinstance(node, Node):
        raise TypeError(f"failed to create {kind}: expected a node handle, got {node!r}")
    failure = f"{_FAILED[kind]} to create {kind}"
    if not node.context.valid:
        raise RCLError(f"{failure}: rcl node's context is invalid")
    try:
        return node, node.resolve_name(name, is_service=kind in ("client", "service"))
    except ValueError as error:
        invalid = _INVALID_NAME[kind].format(name=name, reason=error)
    raise ValueError(f"{failure} due to invalid {invalid}")

"""Service introspection: events about a service's traffic, on `<service>/_service_event`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .clock import Clock
from .qos import profile_of
from .structs import ExtensionEnum

if TYPE_CHECKING:
    from rmw_local.service import ServiceEndpoint

    from .node import Node

# The event types of service_msgs/msg/ServiceEventInfo.
REQUEST_SENT, REQUEST_RECEIVED, RESPONSE_SENT, RESPONSE_RECEIVED = range(4)


class ServiceIntrospectionState(ExtensionEnum):
    """The contents of a service's events."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2


class Introspection:
    """The event publisher of one client or server."""

    def __init__(self, node: Node, endpoint: ServiceEndpoint, clock: Clock, pyqos: object) -> None:
        kind = endpoint.service_type.event
        self._node = node.graph_node
        self._event = kind.cls
        self._writer = self._node.create_writer(kind, f"{endpoint.name}/_service_event", profile_of(pyqos))
        self._clock = clock
        self._with_contents = False

    @classmethod
    def switch(
        cls,
        present: Introspection | None,
        node: Node,
        endpoint: ServiceEndpoint,
        clock: Clock,
        pyqos: object,
        state: ServiceIntrospectionState,
    ) -> Introspection | None:
        """Change to another state; return what does the work from now on."""
        if present is not None:
            present.close()
        if state == ServiceIntrospectionState.OFF:
            return None
        new = cls(node, endpoint, clock, pyqos)
        new._with_contents = state == ServiceIntrospectionState.CONTENTS
        return new

    def record(
        self, event_type: int, client_gid: bytes, number: int, *, request: Any = None, response: Any = None
    ) -> None:
        """Publish one event."""
        event = self._event()
        seconds, nanoseconds = divmod(self._clock.get_now().nanoseconds, 10**9)
        event.info.event_type = event_type
        event.info.stamp.sec = seconds
        event.info.stamp.nanosec = nanoseconds
        event.info.client_gid = list(client_gid)
        event.info.sequence_number = number
        if self._with_contents:
            event.request = [] if request is None else [request]
            event.response = [] if response is None else [response]
        self._writer.publish(event)

    def close(self) -> None:
        """Leave the event topic."""
        self._node.close_writer(self._writer)

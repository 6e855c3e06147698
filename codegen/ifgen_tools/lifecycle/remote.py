"""A running lifecycle node, through its services."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError

from ifgen_tools.ros_graph import node_names
from ifgen_tools.session import find_node

if TYPE_CHECKING:
    from lifecycle_msgs.msg import State, Transition, TransitionDescription

    from ifgen_tools.session import Session

# Late imports: rclpy is found once the transport has been chosen.

_SERVICES_TAKE: Final = 5.0
"""Seconds that a service of a node may take to be discovered."""


def lifecycle_nodes(session: Session, include_hidden: bool = False) -> list[str]:
    """The full names of the lifecycle nodes that are known, sorted."""
    services = dict(session.node.get_service_names_and_types())
    return [
        name
        for name in node_names(session.node, include_hidden)
        if "lifecycle_msgs/srv/GetState" in services.get(f"{name}/get_state", ())
    ]


def find_lifecycle_node(session: Session, name: str, spin_time: float | None = None) -> str:
    """The full name of a lifecycle node that the user named. Raises ToolError if it is none."""
    found = find_node(session, name, spin_time)
    if session.wait_for(lambda: found in lifecycle_nodes(session, True), 1.0):
        return found
    known = ", ".join(lifecycle_nodes(session))
    raise ToolError(f"the node {found!r} is no lifecycle node", f"lifecycle nodes are: {known or 'none'}")


class RemoteLifecycle:
    """A lifecycle node; `node` is its full name. Each method raises ToolError if the node does not answer."""

    def __init__(self, session: Session, node: str) -> None:
        self.node = node
        self._session = session

    def state(self) -> State:
        """Its present state."""
        state: State = self._call("GetState", "get_state").current_state
        return state

    def transitions(self, all_: bool = False) -> list[TransitionDescription]:
        """The transitions out of its present state, or those out of every state."""
        service = "get_transition_graph" if all_ else "get_available_transitions"
        return list(self._call("GetAvailableTransitions", service).available_transitions)

    def change(self, transition: Transition) -> bool:
        """Go through a transition; returns whether that succeeded."""
        return bool(self._call("ChangeState", "change_state", transition=transition).success)

    def _call(self, type_: str, service: str, **request: Any) -> Any:
        """The response of a service, however long it takes: a transition may start a camera."""
        cls = getattr(import_module("lifecycle_msgs.srv"), type_)
        client = self._session.node.create_client(cls, f"{self.node}/{service}")
        try:
            if not self._session.wait_for(client.service_is_ready, _SERVICES_TAKE):
                raise ToolError(
                    f"the node {self.node!r} has no service {service!r}", "it may have just ended"
                )
            future = client.call_async(cls.Request(**request))
            self._session.wait_for(future.done)
        finally:
            self._session.node.destroy_client(client)
        if (error := future.exception()) is not None:
            raise ToolError(f"the node {self.node!r} has not answered on {service!r}: {error}")
        return future.result()

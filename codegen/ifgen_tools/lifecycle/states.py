"""States of running lifecycle nodes and the transitions between them, read and changed through services."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError

from ifgen_tools.lifecycle.options import GetOptions, SetOptions, TransitionsOptions
from ifgen_tools.ros_graph import node_names
from ifgen_tools.session import find_node, open_session
from ifgen_tools.verbs import ListOptions

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


def list_nodes(chosen: ListOptions) -> int:
    """Print the names of the lifecycle nodes."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        session.discover(chosen.spin_time)
        found = lifecycle_nodes(session, chosen.include_hidden)
    if chosen.count:
        print(len(found))
    elif chosen.as_json:
        print(json.dumps(found, indent=2))
    else:
        for name in found:
            print(name)
    return 0


def get_states(chosen: GetOptions) -> int:
    """Print the state of a node, or of all lifecycle nodes."""
    code, found = 0, dict[str, Any]()
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        if chosen.node is None:
            session.discover(chosen.spin_time)
            nodes = lifecycle_nodes(session, chosen.include_hidden)
        else:
            nodes = [find_lifecycle_node(session, chosen.node, chosen.spin_time)]
        for name in nodes:
            try:
                state = RemoteLifecycle(session, name).state()
            except ToolError as error:
                if chosen.node is not None:
                    raise
                code = 1  # the others are shown nevertheless
                print(f"error: {error.message}", file=sys.stderr)
                continue
            found[name] = {"label": state.label, "id": state.id}
            if not chosen.as_json:
                print(f"{'' if chosen.node else f'{name}: '}{state.label} [{state.id}]")
    if chosen.as_json:
        print(json.dumps(found, indent=2))
    return code


def list_transitions(chosen: TransitionsOptions) -> int:
    """Print the transitions out of a node's state, or all of them."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        remote = RemoteLifecycle(session, find_lifecycle_node(session, chosen.node, chosen.spin_time))
        found = remote.transitions(chosen.all_)
    if chosen.as_json:
        print(json.dumps([_plain(each) for each in found], indent=2))
        return 0
    for each in found:
        print(f"- {each.transition.label} [{each.transition.id}]")
        print(f"\tStart: {each.start_state.label}")
        print(f"\tGoal: {each.goal_state.label}")
    return 0


def set_state(chosen: SetOptions) -> int:
    """Go through a transition. Returns 1 if the node has failed to."""
    with open_session(chosen.transport, use_sim_time=chosen.use_sim_time) as session:
        remote = RemoteLifecycle(session, find_lifecycle_node(session, chosen.node, chosen.spin_time))
        available = [each.transition for each in remote.transitions()]
        successful = remote.change(_asked(remote.node, available, chosen.transition))
        state = remote.state() if chosen.as_json else None
    if state is not None:
        print(json.dumps({"successful": successful, "state": {"label": state.label, "id": state.id}}))
    elif successful:
        print("Transitioning successful")
    else:
        print("Transitioning failed", file=sys.stderr)
    return 0 if successful else 1


def _asked(node: str, available: Sequence[Transition], wanted: str) -> Transition:
    """The transition of a label or, if none has it, of a number."""
    for each in available:
        if each.label == wanted:
            return each
    for each in available:
        if str(each.id) == wanted:
            return each
    short = wanted if len(wanted) <= 60 else f"{wanted[:57]}..."
    known = ", ".join(f"{each.label} [{each.id}]" for each in available)
    raise ToolError(f"{node!r} has no transition '{short}' now", f"available ones are: {known or 'none'}")


def _plain(description: TransitionDescription) -> dict[str, object]:
    return {
        "label": description.transition.label,
        "id": description.transition.id,
        "start": {"label": description.start_state.label, "id": description.start_state.id},
        "goal": {"label": description.goal_state.label, "id": description.goal_state.id},
    }

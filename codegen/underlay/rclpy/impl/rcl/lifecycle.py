"""The state machine of managed nodes, with the services and the event topic that show it to others."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Final, NamedTuple

from rmw_local.message import message_type
from rmw_local.qos import QosProfile

from .handle import Destroyable, RCLError, as_bool
from .logging import RCUTILS_LOG_SEVERITY, rclpy_logging_rcutils_log
from .node import Node
from .qos import rmw_qos_profile_t
from .services import Service
from .structs import ScopedEnum

_REFUSED: Final = "Failed to trigger lifecycle state machine transition"
State = tuple[int, str]


class TransitionCallbackReturnType(ScopedEnum):
    """The result of a transition's callback."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99

    def to_label(self) -> str:
        """Return the label of the transition that follows."""
        return f"transition_{self.name.lower()}"


class Transition(NamedTuple):
    """An edge of the state machine."""

    id: int
    label: str
    start: State
    goal: State


_STATES: Final[dict[int, str]] = {
    0: "unknown",
    1: "unconfigured",
    2: "inactive",
    3: "active",
    4: "finalized",
    10: "configuring",
    11: "cleaningup",
    12: "shuttingdown",
    13: "activating",
    14: "deactivating",
    15: "errorprocessing",
}
_OUTCOMES: Final = tuple(kind.to_label() for kind in TransitionCallbackReturnType)
# (label, [(id, start)], passed through, first id of its outcomes, goals of success, failure and error)
_STEPS: Final = (
    ("configure", ((1, 1),), 10, 10, (2, 1, 15)),
    ("cleanup", ((2, 2),), 11, 20, (1, 2, 15)),
    ("activate", ((3, 2),), 13, 30, (3, 2, 15)),
    ("deactivate", ((4, 3),), 14, 40, (2, 3, 15)),
    ("shutdown", ((5, 1), (6, 2), (7, 3)), 12, 50, (4, 4, 15)),
    ("", (), 15, 60, (1, 4, 4)),
)


def _graph() -> Iterable[Transition]:
    for label, starts, through, outcome_id, goals in _STEPS:
        middle = (through, _STATES[through])
        for number, start in starts:
            yield Transition(number, label, (start, _STATES[start]), middle)
        for offset, goal in enumerate(goals):
            yield Transition(outcome_id + offset, _OUTCOMES[offset], middle, (goal, _STATES[goal]))


_GRAPH: Final = tuple(_graph())


class LifecycleStateMachine(Destroyable):
    """The state of a managed node. Raises TypeError if the handle is not that of a node."""

    def __init__(self, node: Node, enable_com_interface: bool) -> None:
        super().__init__()
        if not isinstance(node, Node):
            raise TypeError(f"LifecycleStateMachine(node: Node, enable_com_interface: bool): got {node!r}")
        self._context = node.context
        self._state: State = (1, _STATES[1])
        self._open_event_topic(node)
        self.service_change_state: Service | None = None
        self.service_get_state: Service | None = None
        self.service_get_available_states: Service | None = None
        self.service_get_available_transitions: Service | None = None
        self.service_get_transition_graph: Service | None = None
        if as_bool(enable_com_interface, "enable_com_interface"):
            self._open_services(node)

    def _open_event_topic(self, node: Node) -> None:
        from lifecycle_msgs.msg import TransitionEvent  # only managed nodes need these messages

        self._event_class: type[Any] = TransitionEvent
        graph_node = node.graph_node
        topic = node.resolve_name("~/transition_event", is_service=False)
        self._events = graph_node.create_writer(message_type(TransitionEvent), topic, QosProfile())
        node.at_destruction(lambda: graph_node.close_writer(self._events))

    def _open_services(self, node: Node) -> None:
        # Generated: of use to lifecycle nodes that offer services.
        from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState

        def serve(service_type: type[Any], name: str) -> Service:
            return Service(node, service_type, f"~/{name}", profile)

        profile = rmw_qos_profile_t.predefined("qos_profile_services_default")
        self.service_change_state = serve(ChangeState, "change_state")
        self.service_get_state = serve(GetState, "get_state")
        self.service_get_available_states = serve(GetAvailableStates, "get_available_states")
        self.service_get_available_transitions = serve(GetAvailableTransitions, "get_available_transitions")
        self.service_get_transition_graph = serve(GetAvailableTransitions, "get_transition_graph")

    @property
    def initialized(self) -> bool:
        """Whether it can be used."""
        return not self._destroyed

    @property
    def current_state(self) -> State:
        """(id, label) of the state."""
        return self._state

    @property
    def available_states(self) -> list[State]:
        """(id, label) of every state."""
        return list(_STATES.items())

    @property
    def available_transitions(self) -> list[tuple[int, str, int, str, int, str]]:
        """(id, label, start id, start label, goal id, goal label) of what may be triggered now."""
        return [_flat(transition) for transition in _GRAPH if transition.start == self._state]

    @property
    def transition_graph(self) -> list[tuple[int, str, int, str, int, str]]:
        """As `available_transitions`, for all states."""
        return [_flat(transition) for transition in _GRAPH]

    def get_transition_by_label(self, label: str) -> int:
        """Return the id of a transition that may be triggered now; raises RCLError."""
        transition = self._find(lambda each: each.label == label, label)
        if transition is None:
            raise RCLError("Failed to get transition from label: error not set")
        return transition.id

    def trigger_transition_by_id(self, transition_id: int, publish_update: bool) -> None:
        """Go along a transition; raises RCLError unless it starts here."""
        if not 0 <= transition_id <= 255:
            raise TypeError(f"trigger_transition_by_id(): a transition id is a byte, got {transition_id}")
        self._trigger(self._find(lambda each: each.id == transition_id, transition_id), publish_update)

    def trigger_transition_by_label(self, transition_label: str, publish_update: bool) -> None:
        """Go along a transition; raises RCLError unless it starts here."""
        self._trigger(
            self._find(lambda each: each.label == transition_label, transition_label), publish_update
        )

    def _find(self, matches: Callable[[Transition], bool], wanted: int | str) -> Transition | None:
        for transition in _GRAPH:
            if transition.start == self._state and matches(transition):
                return transition
        text = f"No transition matching {wanted} found for current state {self._state[1]}"
        severity = RCUTILS_LOG_SEVERITY.RCUTILS_LOG_SEVERITY_WARN
        rclpy_logging_rcutils_log(severity, "rcl_lifecycle", text, "", "", 0)
        return None

    def _trigger(self, transition: Transition | None, publish_update: bool) -> None:
        if transition is None:
            raise RCLError(f"{_REFUSED}: Transition is not registered.")
        self._state = transition.goal
        if publish_update and not self._events.closed:
            if not self._context.valid:
                raise RCLError(f"{_REFUSED}: Could not publish transition: publisher's context is invalid")
            event = self._event_class()
            event.transition.id, event.transition.label = transition.id, transition.label
            event.start_state.id, event.start_state.label = transition.start
            event.goal_state.id, event.goal_state.label = transition.goal
            self._events.publish(event)

    def _on_destroy(self) -> None:
        self._events.node.close_writer(self._events)


def _flat(transition: Transition) -> tuple[int, str, int, str, int, str]:
    return (transition.id, transition.label, *transition.start, *transition.goal)

"""Events in the life of managed nodes, and what can be asked of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from launch.event import Event

from launch_ros.events.matchers import matches_node_name

if TYPE_CHECKING:
    from launch_ros.actions import LifecycleNode

__all__ = ["ChangeState", "StateTransition", "matches_node_name"]

# As in lifecycle_msgs, which is imported where nodes are watched, not where a file is read.
STATES = {
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
TRANSITIONS = {
    0: "create",
    1: "configure",
    2: "cleanup",
    3: "activate",
    4: "deactivate",
    5: "unconfigured_shutdown",
    6: "inactive_shutdown",
    7: "active_shutdown",
    8: "destroy",
}


class ChangeState(Event):
    """Some managed nodes are to make a transition: its id is one of `lifecycle_msgs/msg/Transition`."""

    name = "launch_ros.events.lifecycle.ChangeState"
    valid_states = STATES
    valid_transitions = TRANSITIONS

    def __init__(
        self, *, lifecycle_node_matcher: Callable[[LifecycleNode], bool], transition_id: int
    ) -> None:
        if transition_id not in TRANSITIONS:
            raise ValueError(
                f"there is no transition {transition_id}: lifecycle_msgs/msg/Transition lists them"
            )
        self.lifecycle_node_matcher = lifecycle_node_matcher
        self.transition_id = transition_id


class StateTransition(Event):
    """A managed node has made a transition: `msg` is its `lifecycle_msgs/msg/TransitionEvent`."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(self, *, action: LifecycleNode, msg: Any) -> None:
        self.action = action
        self.msg = msg

    @property
    def timestamp(self) -> int:
        """When it was made [ns]."""
        return int(self.msg.timestamp)

    @property
    def transition(self) -> str:
        """The name of the transition."""
        return str(self.msg.transition.label)

    @property
    def start_state(self) -> str:
        """The name of the state before."""
        return str(self.msg.start_state.label)

    @property
    def goal_state(self) -> str:
        """The name of the state after."""
        return str(self.msg.goal_state.label)

"""The goals of an action server: their states, and what changes them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .destroyable import Destroyable
from .enums import ExtensionEnum
from .errors import RCLError

if TYPE_CHECKING:
    from .action_server import ActionServer

# The values of action_msgs/msg/GoalStatus.
ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)
_STATE_NAMES = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")


def key_of(goal_id: Any) -> bytes:
    """The bytes of an id, a unique_identifier_msgs/msg/UUID."""
    key: bytes = goal_id.uuid.tobytes()
    return key


class GoalEvent(ExtensionEnum):
    """Events of an accepted goal."""

    EXECUTE = 0
    CANCEL_GOAL = 1
    SUCCEED = 2
    ABORT = 3
    CANCELED = 4


_NEXT_STATE = {
    (ACCEPTED, GoalEvent.EXECUTE): EXECUTING,
    (ACCEPTED, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.SUCCEED): SUCCEEDED,
    (EXECUTING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.SUCCEED): SUCCEEDED,
    (CANCELING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.CANCELED): CANCELED,
}


class Goal:
    """A goal that a server knows, from acceptance until its result expires."""

    __slots__ = ("accepted_ns", "ended_ns", "state", "uuid")

    def __init__(self, uuid: bytes, accepted_ns: int) -> None:
        self.uuid = uuid
        self.accepted_ns = accepted_ns  # on the server's clock
        self.ended_ns = 0  # the same, once it is in a terminal state
        self.state = ACCEPTED  # a value of GoalStatus

    @property
    def is_active(self) -> bool:
        """Whether it is not in a terminal state."""
        return self.state in (ACCEPTED, EXECUTING, CANCELING)

    @property
    def is_cancelable(self) -> bool:
        """Whether a request to cancel it is allowed."""
        return (self.state, GoalEvent.CANCEL_GOAL) in _NEXT_STATE

    def advance(self, event: GoalEvent) -> None:
        """Change the state; raises RCLError if the event may not happen in it."""
        following = _NEXT_STATE.get((self.state, event))
        if following is None:
            raise RCLError(
                "Failed to update goal state: goal_handle attempted invalid transition "
                f"from state {_STATE_NAMES[self.state]} with event {event.name}"
            )
        self.state = following


class ActionGoalHandle(Destroyable):
    """A goal that a server accepts by the making of this handle, and forgets by its destruction.

    Raises RCLError if the server knows a goal of this id.
    """

    def __init__(self, action_server: ActionServer, pygoal_info: Any) -> None:
        super().__init__()
        self._server = action_server
        self._goal = action_server.accept(pygoal_info)

    def get_status(self) -> int:
        """Return the state as a value of GoalStatus."""
        if self._destroyed:
            raise RCLError("Failed to get goal status: goal handle pointer is invalid")
        return self._goal.state

    def is_active(self) -> bool:
        """Whether the goal is neither destroyed nor in a terminal state."""
        return not self._destroyed and self._goal.is_active

    def update_goal_state(self, event: object) -> None:
        """Change the state; raises RCLError if the event may not happen in the present one."""
        if self._destroyed:
            raise RCLError("Failed to update goal state: goal handle pointer is invalid")
        if not isinstance(event, GoalEvent):
            raise TypeError(f"update_goal_state(event: GoalEvent): got {event!r}")
        self._server.advance(self._goal, event)

    def _on_destroy(self) -> None:
        self._server.forget(self._goal)

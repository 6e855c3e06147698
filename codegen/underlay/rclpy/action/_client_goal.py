"""The client's side of a goal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus

from rclpy.impl.typed import ActionT_co, Generic

if TYPE_CHECKING:
    from action_msgs.srv import CancelGoal
    from builtin_interfaces.msg import Time
    from unique_identifier_msgs.msg import UUID

    from rclpy.action.client import ActionClient
    from rclpy.impl.typed import Action, ResponseT, Service
    from rclpy.task import Future


class ClientGoalHandle(Generic[ActionT_co]):
    """A goal that a server has answered to; what `send_goal_async` results in."""

    def __init__(self, action_client: ActionClient[ActionT_co], goal_id: UUID, goal_response: Any) -> None:
        self._action_client = action_client
        self._goal_id = goal_id
        self._goal_response = goal_response
        self._status: int = GoalStatus.STATUS_UNKNOWN

    def __eq__(self, other: Any) -> bool:
        equal: bool = self._goal_id == other.goal_id
        return equal

    def __ne__(self, other: Any) -> bool:
        return not self == other

    __hash__ = None  # type: ignore[assignment]  # handles are compared by value, as upstream's are

    def __repr__(self) -> str:
        return f"ClientGoalHandle <id={self.goal_id.uuid}, accepted={self.accepted}, status={self.status}>"

    @property
    def goal_id(self) -> UUID:
        """The id, a unique_identifier_msgs/msg/UUID."""
        return self._goal_id

    @property
    def stamp(self) -> Time:
        """The time when the server accepted the goal; zero if it rejected it."""
        stamp: Time = self._goal_response.stamp
        return stamp

    @property
    def accepted(self) -> bool:
        """Whether the server accepted the goal."""
        accepted: bool = self._goal_response.accepted
        return accepted

    @property
    def status(self) -> int:
        """The state that the server last published, a value of action_msgs/msg/GoalStatus; 0 before that."""
        return self._status

    def cancel_goal(self) -> CancelGoal.Response:
        """Ask for the goal to be cancelled and wait for the response (action_msgs/srv/CancelGoal).

        Another thread has to spin. Not for callbacks, because nothing would receive the response there.
        """
        return self._action_client._cancel_goal(self)

    def cancel_goal_async(self) -> Future[CancelGoal.Response]:
        """Ask for the goal to be cancelled; the future completes with the response."""
        return self._action_client._cancel_goal_async(self)

    def get_result(
        self: ClientGoalHandle[Action[Any, Any, Any, Any, Service[Any, ResponseT]]],
    ) -> ResponseT:
        """Ask for the result and wait until the goal has ended; the response has `status` and `result`.

        Another thread has to spin. Not for callbacks, because nothing would receive the response there.
        """
        response: ResponseT = self._action_client._get_result(self)
        return response

    def get_result_async(
        self: ClientGoalHandle[Action[Any, Any, Any, Any, Service[Any, ResponseT]]],
    ) -> Future[ResponseT]:
        """Ask for the result; the future completes, when the goal has ended, with `status` and `result`."""
        return self._action_client._get_result_async(self)

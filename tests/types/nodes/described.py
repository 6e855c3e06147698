"""Users' nodes on base classes that were generated from descriptions."""

from __future__ import annotations

from dance_action_server._dance_action_server_base import DanceActionServerBase
from humanoid_interfaces.action import PerformDance
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future
from std_srvs.srv import SetBool, Trigger
from teleop._teleop_base import TeleopBase


class Remote(TeleopBase):
    """Stops the robot by a service."""

    def stop(self) -> None:
        future = self.call_emergency_stop_set(SetBool.Request(data=True))
        future.add_done_callback(self.tell)
        self.call_emergency_stop_set(Trigger.Request())  # refused: arg-type, reportArgumentType
        future.add_done_callback(self.tell_other)  # refused: arg-type, reportArgumentType
        print(future.result().succes)  # refused: attr-defined, reportAttributeAccessIssue
        self.emergency_stop_set_client.call_async(True)  # refused: arg-type, reportArgumentType

    def tell(self, future: Future[SetBool.Response]) -> None:
        print(future.result().success, future.result().message)

    def tell_other(self, future: Future[Trigger.Response]) -> None:
        print(future.result().success)


class Dancer(DanceActionServerBase):
    """Executes goals."""

    async def accept_perform_dance(self, goal: PerformDance.Goal) -> GoalResponse:
        return GoalResponse.ACCEPT

    async def cancel_perform_dance(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        return CancelResponse.ACCEPT

    async def execute_perform_dance(self, goal_handle: ServerGoalHandle[PerformDance]) -> PerformDance.Result:
        goal_handle.publish_feedback(PerformDance.Feedback())
        goal_handle.publish_feedback(PerformDance.Goal())  # refused: arg-type, reportArgumentType
        print(goal_handle.request.speed_of_light)  # refused: attr-defined, reportAttributeAccessIssue
        return PerformDance.Result()

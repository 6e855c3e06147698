"""The node dance_action_server: written once by ifgen, yours from then on.

`ifgen run -m dance_action_server.dance_action_server` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.action import PerformDance
from humanoid_interfaces.msg import EmergencyStop, FootstepPlan, GaitState
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState

from dance_action_server._dance_action_server_base import DanceActionServerBase
from dance_action_server._dance_action_server_parameters import ParametersError


class DanceActionServer(DanceActionServerBase):
    """Moves waist, head and arms to a beat while the robot stands. At the end of a dance, or as soon as it
    is cancelled, the robot returns to the standing posture.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_footsteps_plan(FootstepPlan())

    async def on_joint_states(self, message: JointState) -> None:
        """Take a message from `/joint_states`.

        Where the joints are
        """
        self.get_logger().debug("message on /joint_states")

    async def on_gait_state(self, message: GaitState) -> None:
        """Take a message from `/gait_state`.

        A dance begins only while the robot stands
        """
        self.get_logger().debug("message on /gait_state")

    async def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Take a message from `/emergency_stop`.

        Ends a dance at once
        """
        self.get_logger().debug("message on /emergency_stop")

    async def accept_perform_dance(self, goal: PerformDance.Goal) -> GoalResponse:
        """Decide whether to accept a goal for `/perform_dance`."""
        return GoalResponse.ACCEPT

    async def cancel_perform_dance(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        """Decide whether a goal of `/perform_dance` may be cancelled."""
        return CancelResponse.ACCEPT

    async def execute_perform_dance(self, goal_handle: ServerGoalHandle) -> PerformDance.Result:
        """Execute a goal of `/perform_dance`."""
        goal_handle.publish_feedback(PerformDance.Feedback())
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.succeed()
        return PerformDance.Result()

    async def on_beat_timer(self) -> None:
        """Called every 0.02 s."""
        self.publish_posture(JointState())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = DanceActionServer()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"dance_action_server: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

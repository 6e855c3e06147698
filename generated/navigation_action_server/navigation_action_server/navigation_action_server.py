"""The node navigation_action_server: written once by ifgen, yours from then on.

`ifgen run -m navigation_action_server.navigation_action_server` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.action import WalkTo
from humanoid_interfaces.msg import EmergencyStop, FootstepPlan, GaitState
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.executors import ExternalShutdownException

from navigation_action_server._navigation_action_server_base import NavigationActionServerBase
from navigation_action_server._navigation_action_server_parameters import ParametersError


class NavigationActionServer(NavigationActionServerBase):
    """Walks to a pose. It requests footsteps, watches the robot take them, plans again when the robot has
    strayed, and stops it within 2.5 s when the goal is cancelled. It walks to one goal at a time: a
    newer goal takes over or is rejected, as `second_goal` says.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_footsteps_plan(FootstepPlan())

    async def on_gait_state(self, message: GaitState) -> None:
        """Take a message from `/gait_state`.

        Where the feet are and which step is being taken
        """
        self.get_logger().debug("message on /gait_state")

    async def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Take a message from `/emergency_stop`.

        Ends the goal and refuses new ones while it is active
        """
        self.get_logger().debug("message on /emergency_stop")

    async def accept_walk_to(self, goal: WalkTo.Goal) -> GoalResponse:
        """Decide whether to accept a goal for `/walk_to`."""
        return GoalResponse.ACCEPT

    async def cancel_walk_to(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        """Decide whether a goal of `/walk_to` may be cancelled."""
        return CancelResponse.ACCEPT

    async def execute_walk_to(self, goal_handle: ServerGoalHandle) -> WalkTo.Result:
        """Execute a goal of `/walk_to`.

        Walk to a pose; a cancel stops with the feet side by side
        """
        goal_handle.publish_feedback(WalkTo.Feedback())
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.succeed()
        return WalkTo.Result()

    async def on_feedback_timer(self) -> None:
        """Called every 0.2 s."""
        self.get_logger().debug("timer feedback")


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = NavigationActionServer()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"navigation_action_server: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""The node gait_planner: written once by ifgen, yours from then on.

`ifgen run -m gait_planner.gait_planner` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist
from humanoid_interfaces.msg import FootstepPlan, GaitState
from rclpy.executors import ExternalShutdownException
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from gait_planner._gait_planner_base import GaitPlannerBase
from gait_planner._gait_planner_parameters import ParametersError


class GaitPlanner(GaitPlannerBase):
    """Takes a plan of footsteps, or a velocity that it turns into steps, and publishes the steps to walk.
    A new plan replaces the old one at once. Plans are passed on unchanged: whole_body_controller
    refuses those that it cannot walk.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_markers(MarkerArray())

    def on_footsteps_plan(self, message: FootstepPlan) -> None:
        """Take a message from `/footsteps/plan`.

        A whole plan. A plan without steps means to stop with the feet side by side. A sender that repeats a
        plan must keep repeating it, at least every 0.5 s: the robot stops when the repetitions stop
        """
        self.get_logger().debug("message on /footsteps/plan")

    def on_humanoid_cmd_vel(self, message: Twist) -> None:
        """Take a message from `/humanoid/cmd_vel`.

        A velocity to walk at, in base_footprint; zero stops the robot, and so does silence for 0.5 s
        """
        self.get_logger().debug("message on /humanoid/cmd_vel")

    def on_gait_state(self, message: GaitState) -> None:
        """Take a message from `/gait_state`.

        Which step the controller is taking
        """
        self.get_logger().debug("message on /gait_state")

    def handle_clear(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Answer a request to `~/clear`.

        Forget all steps that have not begun
        """
        return response

    def on_sign_of_life_timer(self) -> None:
        """Called every 0.02 s."""
        self.publish_footsteps_upcoming(FootstepPlan())

    def on_diagnostics_timer(self) -> None:
        """Called every 1 s."""
        self.publish_diagnostics(DiagnosticArray())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = GaitPlanner()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"gait_planner: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

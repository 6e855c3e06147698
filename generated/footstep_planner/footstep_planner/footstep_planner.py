"""The node footstep_planner: written once by ifgen, yours from then on.

`ifgen run -m footstep_planner.footstep_planner` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from humanoid_interfaces.msg import FootstepPlan, GaitState
from nav_msgs.msg import Odometry, Path
from rclpy.executors import ExternalShutdownException

from footstep_planner._footstep_planner_base import FootstepPlannerBase
from footstep_planner._footstep_planner_parameters import ParametersError


class FootstepPlanner(FootstepPlannerBase):
    """Follows a velocity or a path by asking for footsteps again and again, always a few steps ahead. The
    robot stops when velocities stop arriving.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_footsteps_plan(FootstepPlan())

    async def on_humanoid_cmd_vel(self, message: Twist) -> None:
        """Take a message from `/humanoid/cmd_vel`.

        Wanted velocity in base_footprint
        """
        self.get_logger().debug("message on /humanoid/cmd_vel")

    async def on_plan(self, message: Path) -> None:
        """Take a message from `/plan`.

        A path to follow; a path from before this node started is not walked
        """
        self.get_logger().debug("message on /plan")

    async def on_gait_state(self, message: GaitState) -> None:
        """Take a message from `/gait_state`.

        Where the feet are
        """
        self.get_logger().debug("message on /gait_state")

    async def on_odom(self, message: Odometry) -> None:
        """Take a message from `/odom`.

        Where the base is
        """
        self.get_logger().debug("message on /odom")

    async def on_replan_timer(self) -> None:
        """Called every 0.5 s."""
        self.get_logger().debug("timer replan")


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = FootstepPlanner()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"footstep_planner: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

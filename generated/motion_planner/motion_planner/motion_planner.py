"""The node motion_planner: written once by ifgen, yours from then on.

`ifgen run -m motion_planner.motion_planner` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from nav_msgs.srv import GetPlan
from rclpy.executors import ExternalShutdownException

from motion_planner._motion_planner_base import MotionPlannerBase
from motion_planner._motion_planner_parameters import ParametersError


class MotionPlanner(MotionPlannerBase):
    """Plans a path for the base between two poses on the map, wide enough for the robot."""

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_plan(Path())

    def on_map(self, message: OccupancyGrid) -> None:
        """Take a message from `/map`.

        Where obstacles are
        """
        self.get_logger().debug("message on /map")

    def on_odom(self, message: Odometry) -> None:
        """Take a message from `/odom`.

        Where the robot is; the start if a request has none
        """
        self.get_logger().debug("message on /odom")

    def handle_plan_path(self, request: GetPlan.Request, response: GetPlan.Response) -> GetPlan.Response:
        """Answer a request to `/plan_path`.

        Plan a path between two poses; empty if there is none
        """
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = MotionPlanner()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"motion_planner: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

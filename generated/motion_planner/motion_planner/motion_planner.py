"""The node motion_planner: a path for the base round what is on the map, or the reason why there is none."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from humanoid.planning.routes import RouteStatus, disc_points, plan_route
from humanoid.robot.scene import GROUND
from humanoid.ros import messages
from humanoid.ros.diagnostics import Health
from humanoid.ros.grids import path, read_occupancy_grid
from humanoid.ros.running import run
from humanoid_interfaces.srv import PlanPath
from nav_msgs.msg import OccupancyGrid

from motion_planner._motion_planner_base import MotionPlannerBase
from motion_planner._motion_planner_parameters import ParametersError

_FRAMES = ("", "odom")


class MotionPlanner(MotionPlannerBase):
    """Answers requests with the newest map. What it does not show is taken to be free."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        # What always stands in the scene, and is not seen as an obstacle.
        self._furniture = np.concatenate([disc_points(obstacle) for obstacle in GROUND.obstacles])
        self._points = self._furniture
        self._health = Health("motion_planner: inputs", self.get_logger(), "maps")

    def on_map(self, message: OccupancyGrid) -> None:
        """Take where obstacles are."""
        grid = self._health.read("maps", "/map", read_occupancy_grid, message)
        if grid is not None:
            seen = grid.occupied(self.parameters.occupied_from)
            self._points = np.concatenate([self._furniture, seen])

    def handle_plan_path(self, request: PlanPath.Request, response: PlanPath.Response) -> PlanPath.Response:
        """Plan a path between two poses, or say why there is none."""
        for what, pose in (("start", request.start), ("goal", request.goal)):
            if pose.header.frame_id not in _FRAMES:
                response.status = int(RouteStatus.UNKNOWN_FRAME)
                response.message = f"the {what} is in '{pose.header.frame_id}'; I plan in odom"[:255]
                return response
        start, goal = (
            tuple(float(part) for part in messages.planar(pose.pose))
            for pose in (request.start, request.goal)
        )
        values = self.parameters
        search = values.planner == "a_star"
        route = plan_route(start[:2], goal[:2], self._points, values.clearance, search=search)
        if route.status is RouteStatus.PLANNED and not math.isfinite(goal[2]):
            response.status = int(RouteStatus.INVALID_REQUEST)
            response.message = "the goal holds a number that is not finite"
            return response
        response.status = int(route.status)
        response.message = route.message[:255]
        if route.places:
            response.path = path(route.places, goal[2], self.get_clock().now().nanoseconds)
            self.publish_plan(response.path)
        else:
            self.get_logger().info(f"no path: {route.message}", throttle_duration_sec=5.0)
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node."""
    run(MotionPlanner, args, ParametersError)


if __name__ == "__main__":
    main()

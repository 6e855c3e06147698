"""Tests of what the node motion_planner does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from humanoid.robot.grid import Grid, nearest
from humanoid.ros import messages
from humanoid.ros.grids import occupancy_grid, read_path
from humanoid_interfaces.srv import PlanPath
from motion_planner._motion_planner_base import MAP_SUBSCRIPTION_QOS, PLAN_PUBLISHER_QOS
from motion_planner.motion_planner import MotionPlanner
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.parameter import Parameter

Response = PlanPath.Response


def wall() -> Grid:
    """A map of 4 m x 4 m with a wall across the middle, at x = 0."""
    cells = np.zeros((40, 40), dtype=np.int8)
    cells[10:30, 20] = 100
    return Grid(0.1, -2.0, -2.0, cells)


def request(goal: tuple[float, float, float], frame: str = "odom") -> PlanPath.Request:
    ends = [messages.stamped(0, messages.planar_pose(*place)) for place in ((-1.0, 0.0, 0.0), goal)]
    ends[1].header.frame_id = frame
    return PlanPath.Request(start=ends[0], goal=ends[1])


def started(ros: Any, *parameters: Parameter) -> MotionPlanner:
    node: MotionPlanner = ros.start(MotionPlanner, *parameters, use_sim_time=False)
    walls = ros.peer.create_publisher(OccupancyGrid, "/map", MAP_SUBSCRIPTION_QOS)
    count = len(node._points)
    ros.deliver(
        lambda: walls.publish(occupancy_grid(wall(), 0)), lambda: len(node._points) > count, "the map"
    )
    return node


def test_a_path_leads_round_the_wall(ros: Any) -> None:
    started(ros)
    heard: list[Path] = []
    ros.peer.create_subscription(Path, "/plan", heard.append, PLAN_PUBLISHER_QOS)
    answer = ros.call(PlanPath, "/plan_path", request((1.0, 0.2, 0.5)))
    assert (answer.status, answer.message) == (Response.STATUS_PLANNED, "")
    places, yaw = read_path(answer.path)
    assert (places[0], places[-1]) == ((-1.0, 0.0), pytest.approx((1.0, 0.2)))
    assert yaw == pytest.approx(0.5)
    line = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(places)])
    assert nearest(wall().occupied(), line).min() > 0.36
    ros.spin_until(lambda: heard, "path on /plan")
    assert heard[-1] == answer.path


@pytest.mark.parametrize(
    ("goal", "frame", "status", "why"),
    [
        ((0.1, 0.0, 0.0), "odom", Response.STATUS_GOAL_OCCUPIED, "is 0.07 m from an obstacle"),
        ((1.0, 0.0, 0.0), "map", Response.STATUS_UNKNOWN_FRAME, "the goal is in 'map'; I plan in odom"),
        ((math.nan, 0.0, 0.0), "odom", Response.STATUS_INVALID_REQUEST, "not finite"),
    ],
)
def test_no_path_has_a_reason(
    ros: Any, goal: tuple[float, float, float], frame: str, status: int, why: str
) -> None:
    started(ros)
    answer = ros.call(PlanPath, "/plan_path", request(goal, frame))
    assert answer.status == status
    assert why in answer.message
    assert not answer.path.poses


def test_without_a_search_the_wall_is_the_end(ros: Any) -> None:
    started(ros, Parameter("planner", value="straight"))
    answer = ros.call(PlanPath, "/plan_path", request((1.0, 0.0, 0.0)))
    assert answer.status == Response.STATUS_BLOCKED
    assert "straight line" in answer.message


def test_a_map_that_cannot_be_read_is_left_out(ros: Any) -> None:
    node = started(ros)
    broken = occupancy_grid(wall(), 0)
    broken.info.width = 7
    walls = ros.peer.create_publisher(OccupancyGrid, "/map", MAP_SUBSCRIPTION_QOS)
    count = len(node._points)
    walls.publish(broken)
    assert not ros.spins_until(lambda: len(node._points) != count, 0.2)

"""Tests of what the node motion_planner does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from motion_planner.motion_planner import MotionPlanner
from nav_msgs.srv import GetPlan


def test_handle_plan_path(ros: Any) -> None:
    """The service answers with defaults so far; say here what it should answer."""
    node = ros.start(MotionPlanner, use_sim_time=False)
    name = node.resolve_service_name("/plan_path")
    response = ros.call(GetPlan, name, GetPlan.Request())
    assert response == GetPlan.Response()

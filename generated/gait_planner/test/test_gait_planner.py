"""Tests of what the node gait_planner does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from gait_planner._gait_planner_base import FOOTSTEPS_UPCOMING_PUBLISHER_QOS
from gait_planner.gait_planner import GaitPlanner
from humanoid_interfaces.msg import FootstepPlan


def test_publish_footsteps_upcoming(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(GaitPlanner)
    heard: list[FootstepPlan] = []
    topic = node.resolve_topic_name("/footsteps/upcoming")
    ros.peer.create_subscription(
        FootstepPlan,
        topic,
        heard.append,
        FOOTSTEPS_UPCOMING_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(0.02), lambda: heard, f"message on {topic}")
    assert heard[0] == FootstepPlan()

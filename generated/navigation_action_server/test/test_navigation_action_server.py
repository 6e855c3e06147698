"""Tests of what the node navigation_action_server does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from action_msgs.msg import GoalStatus
from humanoid_interfaces.action import WalkTo
from navigation_action_server.navigation_action_server import NavigationActionServer
from rclpy.action import ActionClient


def test_execute_walk_to(ros: Any) -> None:
    """A goal succeeds with an empty result so far; say here what should come of it."""
    node = ros.start(NavigationActionServer, use_sim_time=False)
    name = node.resolve_topic_name("/walk_to")
    client = ActionClient(ros.peer, WalkTo, name)
    ros.spin_until(client.server_is_ready, "action server")
    handle = ros.result(client.send_goal_async(WalkTo.Goal()), "answer to the goal")
    assert handle.accepted
    response = ros.result(handle.get_result_async(), "result")
    assert response.status == GoalStatus.STATUS_SUCCEEDED
    assert response.result == WalkTo.Result()

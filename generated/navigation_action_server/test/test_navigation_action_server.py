"""Tests of what the node navigation_action_server does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from humanoid.ros import messages
from humanoid_interfaces.action import WalkTo
from navigation_action_server.navigation_action_server import NavigationActionServer
from rclpy.action import ActionClient


def test_no_goal_is_accepted_before_anybody_says_where_the_feet_are(ros: Any) -> None:
    ros.start(NavigationActionServer, use_sim_time=False)
    client = ActionClient(ros.peer, WalkTo, "/walk_to")
    ros.spin_until(client.server_is_ready, "the server")
    goal = WalkTo.Goal(target=messages.stamped(0, messages.planar_pose(0.7, 0.0, 0.0)))
    assert not ros.result(client.send_goal_async(goal), "answer to the goal").accepted

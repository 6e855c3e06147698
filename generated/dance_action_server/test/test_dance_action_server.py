"""Tests of what the node dance_action_server does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from dance_action_server._dance_action_server_base import POSTURE_PUBLISHER_QOS
from dance_action_server.dance_action_server import DanceActionServer
from sensor_msgs.msg import JointState


def test_publish_posture(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(DanceActionServer)
    heard: list[JointState] = []
    topic = node.resolve_topic_name("/posture")
    ros.peer.create_subscription(
        JointState,
        topic,
        heard.append,
        POSTURE_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(0.02), lambda: heard, f"message on {topic}")
    assert heard[0] == JointState()

"""Tests of what the node joint_controller does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from joint_controller._joint_controller_base import JOINT_COMMANDS_PUBLISHER_QOS
from joint_controller.joint_controller import JointController
from sensor_msgs.msg import JointState


def test_publish_joint_commands(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(JointController)
    node.trigger_configure()
    node.trigger_activate()
    heard: list[JointState] = []
    topic = node.resolve_topic_name("/joint_commands")
    ros.peer.create_subscription(
        JointState,
        topic,
        heard.append,
        JOINT_COMMANDS_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(0.01), lambda: heard, f"message on {topic}")
    assert heard[0] == JointState()

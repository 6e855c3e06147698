"""Tests of what the node joint_state_publisher does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from joint_state_publisher._joint_state_publisher_base import JOINT_STATES_PUBLISHER_QOS
from joint_state_publisher.joint_state_publisher import JointStatePublisher
from sensor_msgs.msg import JointState


def test_publish_joint_states(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(JointStatePublisher)
    heard: list[JointState] = []
    topic = node.resolve_topic_name("/joint_states")
    ros.peer.create_subscription(
        JointState,
        topic,
        heard.append,
        JOINT_STATES_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(0.01), lambda: heard, f"message on {topic}")
    assert heard[0] == JointState()

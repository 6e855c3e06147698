"""Tests of what the node teleop does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from geometry_msgs.msg import Twist
from teleop._teleop_base import HUMANOID_CMD_VEL_PUBLISHER_QOS
from teleop.teleop import Teleop


def test_publish_humanoid_cmd_vel(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(Teleop)
    heard: list[Twist] = []
    topic = node.resolve_topic_name("/humanoid/cmd_vel")
    ros.peer.create_subscription(
        Twist,
        topic,
        heard.append,
        HUMANOID_CMD_VEL_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(0.1), lambda: heard, f"message on {topic}")
    assert heard[0] == Twist()

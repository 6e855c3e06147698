"""Tests of what the node whole_body_controller does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from std_msgs.msg import Float64MultiArray
from whole_body_controller._whole_body_controller_base import (
    WHOLE_BODY_POSITION_CONTROLLER_COMMANDS_PUBLISHER_QOS,
)
from whole_body_controller.whole_body_controller import WholeBodyController


def test_publish_whole_body_position_controller_commands(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(WholeBodyController)
    heard: list[Float64MultiArray] = []
    topic = node.resolve_topic_name("/whole_body_position_controller/commands")
    ros.peer.create_subscription(
        Float64MultiArray,
        topic,
        heard.append,
        WHOLE_BODY_POSITION_CONTROLLER_COMMANDS_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(0.004), lambda: heard, f"message on {topic}")
    assert heard[0] == Float64MultiArray()

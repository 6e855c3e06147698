"""Tests of what the node high_level_task_manager does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from high_level_task_manager._high_level_task_manager_base import STATE_PUBLISHER_QOS
from high_level_task_manager.high_level_task_manager import HighLevelTaskManager
from std_msgs.msg import String


def test_publish_state(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(HighLevelTaskManager)
    heard: list[String] = []
    topic = node.resolve_topic_name("~/state")
    ros.peer.create_subscription(
        String,
        topic,
        heard.append,
        STATE_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(1.0), lambda: heard, f"message on {topic}")
    assert heard[0] == String()

"""Tests of what the node humanoid_simulator does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from humanoid_simulator._humanoid_simulator_base import CLOCK_PUBLISHER_QOS
from humanoid_simulator.humanoid_simulator import HumanoidSimulator
from rosgraph_msgs.msg import Clock as rosgraph_msgs_msg_Clock


def test_publish_clock(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(HumanoidSimulator, use_sim_time=False)
    heard: list[rosgraph_msgs_msg_Clock] = []
    topic = node.resolve_topic_name("/clock")
    ros.peer.create_subscription(
        rosgraph_msgs_msg_Clock,
        topic,
        heard.append,
        CLOCK_PUBLISHER_QOS,
    )
    ros.hurry(node.pace_timer)
    ros.spin_until(lambda: heard, f"message on {topic}")
    assert heard[0] == rosgraph_msgs_msg_Clock()

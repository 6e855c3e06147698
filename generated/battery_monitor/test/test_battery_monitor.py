"""Tests of what the node battery_monitor does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from battery_monitor._battery_monitor_base import BATTERY_PUBLISHER_QOS
from battery_monitor.battery_monitor import BatteryMonitor
from humanoid_interfaces.msg import BatteryStatus


def test_publish_battery(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(BatteryMonitor)
    heard: list[BatteryStatus] = []
    topic = node.resolve_topic_name("/battery")
    ros.peer.create_subscription(
        BatteryStatus,
        topic,
        heard.append,
        BATTERY_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(1.0), lambda: heard, f"message on {topic}")
    assert heard[0] == BatteryStatus()

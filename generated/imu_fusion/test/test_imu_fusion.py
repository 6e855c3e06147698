"""Tests of what the node imu_fusion does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from diagnostic_msgs.msg import DiagnosticArray
from imu_fusion._imu_fusion_base import DIAGNOSTICS_PUBLISHER_QOS
from imu_fusion.imu_fusion import ImuFusion


def test_publish_diagnostics(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(ImuFusion)
    heard: list[DiagnosticArray] = []
    topic = node.resolve_topic_name("/diagnostics")
    ros.peer.create_subscription(
        DiagnosticArray,
        topic,
        heard.append,
        DIAGNOSTICS_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(1.0), lambda: heard, f"message on {topic}")
    assert heard[0] == DiagnosticArray()

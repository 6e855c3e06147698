"""Tests of what the node camera_driver does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from camera_driver._camera_driver_base import HEAD_CAMERA_IMAGE_RAW_PUBLISHER_QOS
from camera_driver.camera_driver import CameraDriver
from sensor_msgs.msg import Image


def test_publish_head_camera_image_raw(ros: Any) -> None:
    """The first message says nothing yet; say here what it should say."""
    node = ros.start(CameraDriver)
    node.trigger_configure()
    node.trigger_activate()
    heard: list[Image] = []
    topic = node.resolve_topic_name("/head_camera/image_raw")
    ros.peer.create_subscription(
        Image,
        topic,
        heard.append,
        HEAD_CAMERA_IMAGE_RAW_PUBLISHER_QOS,
    )
    ros.deliver(lambda: ros.pass_time(0.2), lambda: heard, f"message on {topic}")
    assert heard[0] == Image()

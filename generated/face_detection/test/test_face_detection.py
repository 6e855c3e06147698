"""Tests of what the node face_detection does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from face_detection.face_detection import FaceDetection
from humanoid_interfaces.srv import DetectObjects


def test_handle_detect(ros: Any) -> None:
    """The service answers with defaults so far; say here what it should answer."""
    node = ros.start(FaceDetection)
    name = node.resolve_service_name("~/detect")
    client = ros.peer.create_client(DetectObjects, name)
    ros.spin_until(client.service_is_ready, "service")
    response = ros.result(client.call_async(DetectObjects.Request()), "response")
    assert response == DetectObjects.Response()

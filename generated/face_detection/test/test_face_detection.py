"""Tests of what the node face_detection does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from face_detection._face_detection_base import HEAD_CAMERA_IMAGE_RAW_SUBSCRIPTION_QOS as QOS
from face_detection.face_detection import FaceDetection
from humanoid_interfaces.msg import DetectedObjectArray
from humanoid_interfaces.srv import DetectObjects
from sensor_msgs.msg import CameraInfo, Image

WIDTH, HEIGHT = 64, 48


def test_it_looks_at_the_latest_image(ros: Any) -> None:
    node = ros.start(FaceDetection, use_sim_time=False)
    name = node.resolve_service_name("~/detect")
    answer = ros.call(DetectObjects, name, DetectObjects.Request())
    assert (answer.status, answer.message) == (DetectObjects.Response.STATUS_NO_IMAGE, "there is no image")
    images = ros.peer.create_publisher(Image, "/head_camera/image_raw", QOS)
    infos = ros.peer.create_publisher(CameraInfo, "/head_camera/camera_info", QOS)
    found: list[DetectedObjectArray] = []
    ros.peer.create_subscription(DetectedObjectArray, "/face_detection/detections", found.append, 5)
    grey = Image(width=WIDTH, height=HEIGHT, encoding="mono8", step=WIDTH, data=bytes([127] * WIDTH * HEIGHT))

    def picture() -> None:
        infos.publish(
            CameraInfo(width=WIDTH, height=HEIGHT, k=[50.0, 0.0, 32.0, 0.0, 50.0, 24.0, 0.0, 0.0, 1.0])
        )
        images.publish(grey)

    ros.deliver(picture, lambda: found, "detections")
    assert found[-1].objects == []
    assert ros.call(DetectObjects, name, DetectObjects.Request()).status == DetectObjects.Response.STATUS_DONE
    asked = DetectObjects.Request(labels=["unicorn"])
    assert ros.call(DetectObjects, name, asked).status == DetectObjects.Response.STATUS_UNKNOWN_LABEL

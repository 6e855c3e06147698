"""Tests of what the node camera_driver does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from camera_driver._camera_driver_base import (
    HEAD_CAMERA_CAMERA_INFO_PUBLISHER_QOS,
    HEAD_CAMERA_IMAGE_RAW_PUBLISHER_QOS,
    HEAD_CAMERA_SENSOR_SUBSCRIPTION_QOS,
    HEAD_CAMERA_TRIGGER_PUBLISHER_QOS,
)
from camera_driver.camera_driver import CameraDriver
from humanoid.ros.images import image, read_image
from rclpy.parameter import Parameter
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Empty, Header
from std_srvs.srv import SetBool

PICTURE = np.arange(48 * 64 * 3, dtype=np.uint32).astype(np.uint8).reshape(48, 64, 3)


class Sensor:
    """The sensor on the other side, and a listener."""

    def __init__(self, ros: Any) -> None:
        self.triggers: list[Empty] = []
        self.images: list[Image] = []
        self.infos: list[CameraInfo] = []
        self._pictures = ros.peer.create_publisher(
            Image, "/head_camera/sensor", HEAD_CAMERA_SENSOR_SUBSCRIPTION_QOS
        )
        for kind, name, heard, qos in (
            (Empty, "trigger", self.triggers, HEAD_CAMERA_TRIGGER_PUBLISHER_QOS),
            (Image, "image_raw", self.images, HEAD_CAMERA_IMAGE_RAW_PUBLISHER_QOS),
            (CameraInfo, "camera_info", self.infos, HEAD_CAMERA_CAMERA_INFO_PUBLISHER_QOS),
        ):
            ros.peer.create_subscription(kind, f"/head_camera/{name}", heard.append, qos)

    def deliver(self) -> None:
        self._pictures.publish(image(Header(frame_id="sensor"), PICTURE))


def started(ros: Any, **parameters: Any) -> CameraDriver:
    overrides = {"capture_period": 0.1, "image.width": 32, "image.height": 24, **parameters}
    node: CameraDriver = ros.start(CameraDriver, *(Parameter(k, value=v) for k, v in overrides.items()))
    node.trigger_configure()
    node.trigger_activate()
    return node


def test_a_trigger_gives_an_image_with_its_calibration(ros: Any) -> None:
    started(ros, streaming=True)
    sensor = Sensor(ros)
    ros.deliver(lambda: ros.pass_time(0.1), lambda: sensor.triggers, "trigger")
    ros.deliver(sensor.deliver, lambda: sensor.images and sensor.infos, "image")
    shown, info = sensor.images[-1], sensor.infos[-1]
    assert (shown.width, shown.height, shown.encoding) == (32, 24, "rgb8")
    assert shown.header.frame_id == info.header.frame_id == "head_camera_optical_frame"
    assert np.array_equal(read_image(shown), PICTURE[1::2, 1::2])
    assert (info.width, info.height) == (32, 24)
    assert info.k[0] == pytest.approx(12 / np.tan(np.pi / 6))
    assert (info.k[2], info.k[5]) == (16, 12)


def test_pictures_that_do_not_come_are_counted(ros: Any) -> None:
    node = started(ros, streaming=True)
    sensor = Sensor(ros)
    ros.deliver(lambda: ros.pass_time(0.1), lambda: node._health.counts["drop-outs"] >= 2, "drop-outs")
    before = node._health.counts["drop-outs"]
    assert sensor.images == []
    ros.deliver(sensor.deliver, lambda: sensor.images, "image")
    assert not node._waits
    assert node._health.counts["drop-outs"] >= before


def test_nothing_is_captured_before_somebody_asks(ros: Any) -> None:
    started(ros)
    sensor = Sensor(ros)
    for _ in range(5):
        ros.pass_time(0.1)
    assert not ros.spins_until(lambda: sensor.triggers, 0.2)
    answer = ros.call(SetBool, "/camera_driver/set_streaming", SetBool.Request(data=True))
    assert answer.success
    ros.deliver(lambda: ros.pass_time(0.1), lambda: sensor.triggers, "trigger")


def test_a_picture_too_narrow_is_refused(ros: Any) -> None:
    node = started(ros, streaming=True, **{"image.width": 300})
    sensor = Sensor(ros)
    ros.deliver(sensor.deliver, lambda: node._health.counts["pictures"], "refusal")
    assert sensor.images == []

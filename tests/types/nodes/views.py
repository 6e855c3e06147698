"""Messages with views: their sequences of numbers are arrays of numpy, and checkers know which have them."""

from __future__ import annotations

from typing import assert_type

import numpy
from geometry_msgs.msg import Point
from ifgen_runtime import deserialize
from ifgen_runtime.numpy import as_array, image_array
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState
from std_srvs.srv import SetBool
from stereo_msgs.msg import DisparityImage
from trajectory_msgs.msg import JointTrajectory


class Camera(Node):
    """Receives images without a copy."""

    def __init__(self) -> None:
        super().__init__("camera")
        self.create_subscription(Image, "image", self.on_image, 10, views=True)
        self.create_subscription(Image, "image", self.on_any_image, 10, views=True)
        self.create_subscription(Point, "point", self.on_point, 10, views=True)
        self.create_subscription(Image, "image", self.on_bytes, 10, raw=True)
        self.create_subscription(Image, "image", self.on_image, 10)  # refused: arg-type, reportArgumentType
        self.create_subscription(
            Image, "image", self.on_point, 10, views=True
        )  # refused: arg-type, reportArgumentType
        self.images = self.create_publisher(Image, "out", 10)

    def on_image(self, image: Image.Views) -> None:
        """Look at it, write to it, and pass it on."""
        assert_type(image.data, NDArray[numpy.uint8])
        print(image.data.mean(), image.header.frame_id, image_array(image), as_array(image.data))
        image.data[0] = 1
        image.data += 1
        image.data = image.data[:2]
        image.data.append(1)  # refused: attr-defined, reportAttributeAccessIssue
        self.images.publish(image)

    def on_any_image(self, image: Image) -> None:
        """Take one with views, too: it is an image."""

    def on_point(self, point: Point) -> None:
        """Take a message that has no sequences."""

    def on_bytes(self, data: bytes) -> None:
        """Do the same on both transports."""
        self.on_image(deserialize(data, Image, views=True))
        self.on_image(deserialize(data, Image))  # refused: arg-type, reportArgumentType
        assert_type(deserialize(data, Image).data.tolist(), list[int])
        assert_type(deserialize(data, JointState, views=True).position, NDArray[numpy.float64])
        assert_type(deserialize(data, DisparityImage, views=True).image.data, NDArray[numpy.uint8])
        trajectory = deserialize(data, JointTrajectory, views=True)
        assert_type(trajectory.points[0].positions, NDArray[numpy.float64])
        assert_type(deserialize(data, Point, views=True), Point)
        assert_type(deserialize(data, SetBool.Request, views=True), SetBool.Request)

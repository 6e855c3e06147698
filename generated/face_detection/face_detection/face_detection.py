"""The node face_detection: written once by ifgen, yours from then on."""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.msg import DetectedObjectArray
from humanoid_interfaces.srv import DetectObjects
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import CameraInfo, Image

from face_detection._face_detection_base import FaceDetectionBase
from face_detection._face_detection_parameters import ParametersError


class FaceDetection(FaceDetectionBase):
    """Finds faces, and markers that stand for faces, in the pictures of the head camera. Works on the
    latest picture only: one that arrives during a detection replaces those before it.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_face_detection_detections(DetectedObjectArray())

    def on_head_camera_image_raw(self, message: Image) -> None:
        """Take a message from `/head_camera/image_raw`.

        The picture
        """
        self.get_logger().debug("message on /head_camera/image_raw")

    def on_head_camera_camera_info(self, message: CameraInfo) -> None:
        """Take a message from `/head_camera/camera_info`.

        Its calibration
        """
        self.get_logger().debug("message on /head_camera/camera_info")

    def handle_detect(
        self,
        request: DetectObjects.Request,
        response: DetectObjects.Response,
    ) -> DetectObjects.Response:
        """Answer a request to `~/detect`.

        What the latest picture shows
        """
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = FaceDetection()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"face_detection: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""The node face_detection: written once by ifgen, yours from then on.

`ifgen run -m face_detection.face_detection` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

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
    """Finds faces, and markers that stand for faces, in the images of the head camera. It works on the
    latest image only: an image that arrives during a detection replaces those before it.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_face_detection_detections(DetectedObjectArray())

    def on_head_camera_image_raw(self, message: Image) -> None:
        """Take a message from `/head_camera/image_raw`.

        The image
        """
        self.get_logger().debug("message on /head_camera/image_raw")

    def on_head_camera_camera_info(self, message: CameraInfo) -> None:
        """Take a message from `/head_camera/camera_info`.

        The calibration of the camera
        """
        self.get_logger().debug("message on /head_camera/camera_info")

    def handle_detect(
        self,
        request: DetectObjects.Request,
        response: DetectObjects.Response,
    ) -> DetectObjects.Response:
        """Answer a request to `~/detect`.

        Detect objects in the latest image
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

"""The node camera_driver: written once by ifgen, yours from then on.

`ifgen run -m camera_driver.camera_driver` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import CameraInfo, Image
from std_srvs.srv import SetBool

from camera_driver._camera_driver_base import CameraDriverBase
from camera_driver._camera_driver_parameters import ParametersError


class CameraDriver(CameraDriverBase):
    """Publishes the images of the head camera and the calibration that is needed to measure in them.
    Nothing is captured until somebody asks for it. Images cost more than everything else that the robot
    sends.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    def handle_set_streaming(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Answer a request to `~/set_streaming`.

        Start or stop capturing
        """
        return response

    def on_capture_timer(self) -> None:
        """Called every `capture_period` [s]."""
        self.publish_head_camera_image_raw(Image())
        self.publish_head_camera_camera_info(CameraInfo())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = CameraDriver()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"camera_driver: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

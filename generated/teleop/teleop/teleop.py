"""The node teleop: written once by ifgen, yours from then on.

`ifgen run -m teleop.teleop` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import Joy

from teleop._teleop_base import TeleopBase
from teleop._teleop_parameters import ParametersError


class Teleop(TeleopBase):
    """Turns the axes of a joystick into velocity commands. The dead-man button must be held. When it is
    released, or the joystick falls silent, the command is zero.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    def on_joy(self, message: Joy) -> None:
        """Take a message from `/joy`.

        Axes and buttons
        """
        self.get_logger().debug("message on /joy")

    def on_command_timer(self) -> None:
        """Called every 0.1 s."""
        self.publish_humanoid_cmd_vel(Twist())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = Teleop()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"teleop: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

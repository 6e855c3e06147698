"""The node joint_controller: written once by ifgen, yours from then on.

`ifgen run -m joint_controller.joint_controller` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.msg import EmergencyStop
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import SetBool

from joint_controller._joint_controller_base import JointControllerBase
from joint_controller._joint_controller_parameters import ParametersError

# fmt: off


class JointController(JointControllerBase):
    """The last node before the motors. It passes position set-points on, limited in range and speed, and
    lets nothing through that is late, incomplete or not a number. Without a valid command it holds its
    present posture.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    def on_whole_body_position_controller_commands(self, message: Float64MultiArray) -> None:
        """Take a message from `/whole_body_position_controller/commands`.

        Position set-points [rad] in the order of the parameter joints
        """
        self.get_logger().debug("message on /whole_body_position_controller/commands")

    def on_joint_states(self, message: JointState) -> None:
        """Take a message from `/joint_states`.

        Angles [rad] and velocities [rad/s] as measured
        """
        self.get_logger().debug("message on /joint_states")

    def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Take a message from `/emergency_stop`.

        Overrides every command
        """
        self.get_logger().debug("message on /emergency_stop")

    def handle_hold(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Answer a request to `~/hold`.

        Hold the present posture whatever is commanded, or stop holding it
        """
        return response

    def on_control_timer(self) -> None:
        """Called every `control_period` [s]."""
        self.publish_joint_commands(JointState())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = JointController()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"joint_controller: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

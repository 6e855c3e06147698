"""The node joint_state_publisher: written once by ifgen, yours from then on.

`ifgen run -m joint_state_publisher.joint_state_publisher` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState

from joint_state_publisher._joint_state_publisher_base import JointStatePublisherBase
from joint_state_publisher._joint_state_publisher_parameters import ParametersError


class JointStatePublisher(JointStatePublisherBase):
    """Collects what the joint drivers measure and publishes it in one fixed order at a steady rate. A
    joint that no driver reports keeps its last value.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    def on_joint_encoders(self, message: JointState) -> None:
        """Take a message from `/joint_encoders`.

        Partial states, one message per driver
        """
        self.get_logger().debug("message on /joint_encoders")

    def on_publish_timer(self) -> None:
        """Called every 0.01 s."""
        self.publish_joint_states(JointState())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = JointStatePublisher()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"joint_state_publisher: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

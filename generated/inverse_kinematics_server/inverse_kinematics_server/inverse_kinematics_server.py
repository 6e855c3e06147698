"""The node inverse_kinematics_server: written once by ifgen, yours from then on.

`ifgen run -m inverse_kinematics_server.inverse_kinematics_server` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState

from inverse_kinematics_server._inverse_kinematics_server_base import InverseKinematicsServerBase
from inverse_kinematics_server._inverse_kinematics_server_parameters import ParametersError


class InverseKinematicsServer(InverseKinematicsServerBase):
    """Finds the joint angles that bring a hand, a foot or the head to a pose, and reports how far off the
    best answer is.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)

    def on_joint_states(self, message: JointState) -> None:
        """Take a message from `/joint_states`.

        Where the joints are; the seed if a request has none
        """
        self.get_logger().debug("message on /joint_states")

    def handle_solve_ik(self, request: SolveIK.Request, response: SolveIK.Response) -> SolveIK.Response:
        """Answer a request to `/solve_ik`.

        Find the joint angles that bring the tip of a chain to a pose
        """
        return response

    def handle_check_head_pose(
        self,
        request: CheckHeadPose.Request,
        response: CheckHeadPose.Response,
    ) -> CheckHeadPose.Response:
        """Answer a request to `/check_head_pose`.

        Tell whether waist and head can bring the gaze to a pose or to a point
        """
        return response


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = InverseKinematicsServer()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"inverse_kinematics_server: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

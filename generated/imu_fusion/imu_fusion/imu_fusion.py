"""The node imu_fusion: written once by ifgen, yours from then on.

`ifgen run -m imu_fusion.imu_fusion` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from humanoid_interfaces.msg import GaitState
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import Imu, JointState
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from imu_fusion._imu_fusion_base import ImuFusionBase
from imu_fusion._imu_fusion_parameters import ParametersError


class ImuFusion(ImuFusionBase):
    """Estimates the pose and velocity of the base from the IMU, the joint angles and the loads on the feet
    (leg odometry). It uses no ground truth: the estimate drifts by a few millimetres per step.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_odom(Odometry())
        self.publish_tf(TFMessage())

    def on_joint_states(self, message: JointState) -> None:
        """Take a message from `/joint_states`.

        Angles [rad] and velocities [rad/s] of all joints
        """
        self.get_logger().debug("message on /joint_states")

    def on_imu_data(self, message: Imu) -> None:
        """Take a message from `/imu/data`.

        Orientation, angular velocity and acceleration (gravity included) of the pelvis
        """
        self.get_logger().debug("message on /imu/data")

    def on_l_foot_wrench(self, message: WrenchStamped) -> None:
        """Take a message from `/l_foot/wrench`.

        Force [N] and torque [N m] of the floor on the left ankle
        """
        self.get_logger().debug("message on /l_foot/wrench")

    def on_r_foot_wrench(self, message: WrenchStamped) -> None:
        """Take a message from `/r_foot/wrench`.

        Force [N] and torque [N m] of the floor on the right ankle
        """
        self.get_logger().debug("message on /r_foot/wrench")

    def on_gait_state(self, message: GaitState) -> None:
        """Take a message from `/gait_state`.

        Which foot is planned to carry the robot
        """
        self.get_logger().debug("message on /gait_state")

    def handle_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Answer a request to `~/reset`.

        Take the present pose of the base as the origin of odom
        """
        return response

    def on_diagnostics_timer(self) -> None:
        """Called every 1 s."""
        self.publish_diagnostics(DiagnosticArray())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = ImuFusion()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"imu_fusion: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

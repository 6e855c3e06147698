"""The node whole_body_controller: written once by ifgen, yours from then on.

`ifgen run -m whole_body_controller.whole_body_controller` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from humanoid_interfaces.msg import EmergencyStop, FootstepPlan, GaitState
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import Trigger

from whole_body_controller._whole_body_controller_base import WholeBodyControllerBase
from whole_body_controller._whole_body_controller_parameters import ParametersError

# fmt: off


class WholeBodyController(WholeBodyControllerBase):
    """Balances the robot and follows footsteps at 250 Hz: it turns sensor values into position set-points
    of all joints. It knows nothing about goals. When commands stop arriving, or make no sense, it ends
    the step in progress and stands.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_gait_state(GaitState())

    def on_joint_states(self, message: JointState) -> None:
        """Take a message from `/joint_states`.

        Angles [rad] and velocities [rad/s] of all joints
        """
        self.get_logger().debug("message on /joint_states")

    def on_imu_data(self, message: Imu) -> None:
        """Take a message from `/imu/data`.

        Orientation and angular velocity of the pelvis
        """
        self.get_logger().debug("message on /imu/data")

    def on_odom(self, message: Odometry) -> None:
        """Take a message from `/odom`.

        Pose and velocity of the base, as estimated
        """
        self.get_logger().debug("message on /odom")

    def on_footsteps_upcoming(self, message: FootstepPlan) -> None:
        """Take a message from `/footsteps/upcoming`.

        Steps to take, soonest first
        """
        self.get_logger().debug("message on /footsteps/upcoming")

    def on_posture(self, message: JointState) -> None:
        """Take a message from `/posture`.

        Wanted angles of waist, head and arms [rad], by name, and `squat` [m]; without names, the standing
        posture
        """
        self.get_logger().debug("message on /posture")

    def on_emergency_stop(self, message: EmergencyStop) -> None:
        """Take a message from `/emergency_stop`.

        Overrides every other command
        """
        self.get_logger().debug("message on /emergency_stop")

    def on_servos_standby(self, message: String) -> None:
        """Take a message from `/servos/standby`.

        Why the servos hold the robot on their own; empty while they follow set-points
        """
        self.get_logger().debug("message on /servos/standby")

    def handle_stop(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Answer a request to `~/stop`.

        End the step in progress and stand with the feet side by side
        """
        return response

    def on_control_timer(self) -> None:
        """Called every `control.period` [s]."""
        self.publish_whole_body_position_controller_commands(Float64MultiArray())

    def on_diagnostics_timer(self) -> None:
        """Called every 1 s."""
        self.publish_diagnostics(DiagnosticArray())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = WholeBodyController()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"whole_body_controller: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

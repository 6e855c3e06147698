"""The node humanoid_simulator: written once by ifgen, yours from then on.

`ifgen run -m humanoid_simulator.humanoid_simulator` runs it with a ROS 2 or without.
Plain `python` needs a ROS 2 that is sourced.
"""

from __future__ import annotations

import sys
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from humanoid_interfaces.msg import Stance
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rosgraph_msgs.msg import Clock as rosgraph_msgs_msg_Clock
from sensor_msgs.msg import BatteryState, CameraInfo, Image, Imu, JointState
from std_msgs.msg import Bool, Float64MultiArray, String
from std_srvs.srv import SetBool, Trigger
from tf2_msgs.msg import TFMessage

from humanoid_simulator._humanoid_simulator_base import HumanoidSimulatorBase
from humanoid_simulator._humanoid_simulator_parameters import ParametersError

# fmt: off


class HumanoidSimulator(HumanoidSimulatorBase):
    """Steps the physics of the humanoid and is the only source of time. It publishes what the sensors
    measure, stamped with the time on /clock, and passes incoming set-points to the joints. It does not
    balance the robot.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rclpy.node.Node`."""
        super().__init__(**options)
        self.publish_l_foot_contact(Bool())
        self.publish_r_foot_contact(Bool())
        self.publish_head_camera_image_raw(Image())
        self.publish_head_camera_camera_info(CameraInfo())
        self.publish_battery_state(BatteryState())
        self.publish_diagnostics(DiagnosticArray())
        self.publish_servos_standby(String())
        self.publish_robot_description(String())
        self.publish_tf_static(TFMessage())
        self.publish_ground_truth_odom(Odometry())
        self.publish_ground_truth_stance(Stance())

    def on_whole_body_position_controller_commands(self, message: Float64MultiArray) -> None:
        """Take a message from `/whole_body_position_controller/commands`.

        Position set-points [rad] of all joints, in the model's order. dim[0] is the joints; dim[1] is
        labelled `stamp` and holds the stamp of the sensor values that the set-points answer, as size [s]
        and stride [ns]
        """
        self.get_logger().debug("message on /whole_body_position_controller/commands")

    def on_push(self, message: WrenchStamped) -> None:
        """Take a message from `~/push`.

        A push on the torso for 0.1 s, force [N] in map
        """
        self.get_logger().debug("message on ~/push")

    def handle_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Answer a request to `~/reset`.

        Stand the robot up where it started
        """
        return response

    def handle_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Answer a request to `~/pause`.

        Stop time, or let it run on
        """
        return response

    def handle_step(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Answer a request to `~/step`.

        Run one control period while paused
        """
        return response

    def on_pace_timer(self) -> None:
        """Called every `control_period` [s]."""
        self.publish_clock(rosgraph_msgs_msg_Clock())
        self.publish_joint_states(JointState())
        self.publish_imu_data(Imu())
        self.publish_l_foot_wrench(WrenchStamped())
        self.publish_r_foot_wrench(WrenchStamped())


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or a shutdown from outside."""
    rclpy.init(args=args)
    try:
        node = HumanoidSimulator()
    except ParametersError as error:
        rclpy.try_shutdown()
        sys.exit(f"humanoid_simulator: {error}")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

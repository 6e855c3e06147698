"""The program `robot_state_publisher`: the frames of a robot from its URDF and the states of its joints."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, Final

from builtin_interfaces.msg import Time as Stamp
from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

from robot_state_publisher._program import run
from robot_state_publisher.urdf import MOVING, Joint, Robot, UrdfError, read_urdf

_LATCHED: Final = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotStatePublisher(Node):
    """Publishes /tf_static once, /tf for each state of joints, and /robot_description.

    Parameters: `robot_description` (the URDF), `frame_prefix`, `publish_frequency` [Hz], the highest rate of
    the transforms of a joint, and `ignore_timestamp`, to publish also what is older than what was published.
    """

    def __init__(self, description: str = "", **kwargs: Any) -> None:
        """Raise UrdfError if the description is no robot's."""
        super().__init__("robot_state_publisher", **kwargs)
        text = str(self.declare_parameter("robot_description", description).value)
        self._prefix = str(self.declare_parameter("frame_prefix", "").value)
        self._frequency = float(self.declare_parameter("publish_frequency", 20.0).value or 0.0)
        self._ignores_stamps = bool(self.declare_parameter("ignore_timestamp", False).value)
        if not 0.0 <= self._frequency <= 1000.0:
            raise UrdfError(f"publish_frequency must be between 0 and 1000, got {self._frequency}")
        self._robot: Robot = read_urdf(text)
        self._published: dict[str, int] = {}
        self._last_state = 0
        self._moving = TransformBroadcaster(self)
        self._static = StaticTransformBroadcaster(self)
        self._descriptions = self.create_publisher(String, "robot_description", _LATCHED)
        self._publish_robot(text)
        self.create_subscription(JointState, "joint_states", self._on_joint_state, qos_profile_sensor_data)
        self.add_on_set_parameters_callback(self._on_parameters)
        self.get_logger().info("Robot initialized")

    def _publish_robot(self, text: str) -> None:
        self._descriptions.publish(String(data=text))
        now = self.get_clock().now().to_msg()
        joints = self._robot.joints.values()
        fixed = [self._transform(joint, 0.0, now) for joint in joints if _is_fixed(joint)]
        if fixed:
            self._static.sendTransform(fixed)

    def _on_joint_state(self, state: JointState) -> None:
        if len(state.name) != len(state.position):
            if state.position:
                self.get_logger().error(
                    f"a state of joints has {len(state.name)} names and {len(state.position)} positions"
                )
            else:
                self.get_logger().warning(
                    "a state of joints has no positions, ignored", throttle_duration_sec=1.0
                )
            return
        stamp = state.header.stamp
        at = Time.from_msg(stamp).nanoseconds
        known = [self._published[name] for name in state.name if name in self._published]
        if at < self._last_state:  # time went back: a simulation or a bag began again
            self.get_logger().warning("time went back, publishing again")
            self._published.clear()
            known = []
        self._last_state = at
        interval = 1e9 / self._frequency if self._frequency else 0.0
        if known and not self._ignores_stamps and at < min(known) + interval:
            return
        positions = self._robot.with_mimics(dict(zip(state.name, state.position, strict=True)))
        moving = [
            self._transform(joint, positions[name], stamp)
            for name, joint in self._robot.joints.items()
            if name in positions and joint.type in MOVING
        ]
        if moving:
            self._moving.sendTransform(moving)
        self._published.update(dict.fromkeys(state.name, at))

    def _transform(self, joint: Joint, position: float, stamp: Stamp) -> TransformStamped:
        message = TransformStamped()
        message.header.stamp = stamp
        message.header.frame_id = self._prefix + joint.parent
        message.child_frame_id = self._prefix + joint.child
        translation, rotation = joint.pose(position)
        at, turned = message.transform.translation, message.transform.rotation
        at.x, at.y, at.z = translation
        turned.x, turned.y, turned.z, turned.w = rotation
        return message

    def _on_parameters(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Take new values, or say why not."""
        text: str | None = None
        for parameter in parameters:
            value: Any = parameter.value
            match parameter.name:
                case "robot_description":
                    try:
                        self._robot, text = read_urdf(str(value)), str(value)
                    except UrdfError as error:
                        return SetParametersResult(successful=False, reason=str(error))
                case "publish_frequency":
                    if not 0.0 <= value <= 1000.0:
                        reason = "publish_frequency must be between 0.0 and 1000.0"
                        return SetParametersResult(successful=False, reason=reason)
                    self._frequency = value
                case "frame_prefix":
                    self._prefix = value
                case "ignore_timestamp":
                    self._ignores_stamps = value
                case _:
                    pass
        if text is not None:
            self._publish_robot(text)
        return SetParametersResult(successful=True)


def _is_fixed(joint: Joint) -> bool:
    return joint.type in {"fixed", "planar"}  # upstream takes a planar joint for a fixed one


def main(args: Sequence[str] | None = None) -> int:
    """Run the program: `[FILE] --ros-args -p robot_description:=...`."""
    return run(
        "robot_state_publisher",
        RobotStatePublisher,
        args,
        "; the URDF belongs into the parameter robot_description",
    )


if __name__ == "__main__":
    sys.exit(main())

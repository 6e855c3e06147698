"""The program `joint_state_publisher`: states for the joints of a robot that nobody else has values for."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from robot_state_publisher._program import run
from robot_state_publisher.urdf import MOVING, Joint, Mimic, Robot, UrdfError, read_urdf

_LATCHED: Final = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class JointStatePublisher(Node):
    """Publishes /joint_states: positions from the topics in `source_list`, else the middle or 0.

    Parameters: `rate` [Hz], `source_list`, `zeros.JOINT` [rad or m], `publish_default_positions`,
    `publish_default_velocities`, `publish_default_efforts`, `use_mimic_tags`, `use_smallest_joint_limits`
    (those of safety controllers, too), `dependent_joints.JOINT.parent`, `.factor` and `.offset`, and
    `delta`, the step [rad or m] by which each joint moves to and fro.
    """

    def __init__(self, description: str = "", **kwargs: Any) -> None:
        """Raise UrdfError if the description is no robot's."""
        super().__init__(
            "joint_state_publisher",
            allow_undeclared_parameters=True,
            automatically_declare_parameters_from_overrides=True,
            **kwargs,
        )
        self._has_positions = bool(self._given("publish_default_positions", True))
        self._has_velocities = bool(self._given("publish_default_velocities", False))
        self._has_efforts = bool(self._given("publish_default_efforts", False))
        self._delta = float(self._given("delta", 0.0))
        rate = float(self._given("rate", 10.0))
        if not rate > 0.0:
            raise UrdfError(f"the parameter rate must be positive, got {rate}")
        self._robot: Robot | None = None
        self._positions: dict[str, float] = {}
        self._velocities: dict[str, float] = {}
        self._efforts: dict[str, float] = {}
        self._directions: dict[str, int] = {}
        self._limits: dict[str, tuple[float, float]] = {}
        self._followers: dict[str, Mimic] = {}
        self._publisher = self.create_publisher(JointState, "joint_states", 10)
        if description:
            self._take(description)
        else:
            self.create_subscription(String, "robot_description", self._on_description, _LATCHED)
            self.get_logger().info("Waiting for a robot on the topic robot_description...")
        for topic in self._given("source_list", []) or ():
            self.create_subscription(JointState, topic, self._on_source, 10)
        self.create_timer(1.0 / rate, self.publish)

    def _given(self, name: str, default: Any) -> Any:
        return self.get_parameter_or(name).value if self.has_parameter(name) else default

    def _on_description(self, message: String) -> None:
        try:
            self._take(message.data)
        except UrdfError as error:
            self.get_logger().error(f"cannot use the robot description: {error}")

    def _take(self, text: str) -> None:
        robot = read_urdf(text)
        self._limits = {name: self._limits_of(joint) for name, joint in robot.joints.items()}
        self._followers = self._followers_in(robot)
        self._positions = {
            name: float(self._given(f"zeros.{name}", _middle(*self._limits[name])))
            for name, joint in robot.joints.items()
            if joint.type in MOVING and name not in self._followers
        }
        self._directions = dict.fromkeys(self._positions, 1)
        self._robot = robot

    def _limits_of(self, joint: Joint) -> tuple[float, float]:
        if self._given("use_smallest_joint_limits", True):
            return max(joint.lower, joint.soft_lower), min(joint.upper, joint.soft_upper)
        return joint.lower, joint.upper

    def _followers_in(self, robot: Robot) -> dict[str, Mimic]:
        """The joints that follow another one, by the description and by parameters. Raises UrdfError."""
        followers: dict[str, Mimic] = {}
        if self._given("use_mimic_tags", True):
            followers = {name: j.mimic for name, j in robot.joints.items() if j.mimic is not None}
        given = self.get_parameters_by_prefix("dependent_joints")
        for name in dict.fromkeys(each.rpartition(".")[0] for each in given):
            parent, factor, offset = (
                self._given(f"dependent_joints.{name}.{part}", default)
                for part, default in (("parent", ""), ("factor", 1.0), ("offset", 0.0))
            )
            for joint, what in ((name, "a joint"), (parent, "a parent")):
                if joint not in robot.joints:
                    raise UrdfError(
                        f"dependent_joints.{name}: '{joint}' is {what} that the robot does not have"
                    )
            followers[name] = Mimic(parent, float(factor), float(offset))
        for name in followers:
            at, seen = name, {name}
            while at in followers:
                at = followers[at].joint
                if at in seen:
                    raise UrdfError(f"the joints {', '.join(sorted(seen))} follow each other")
                seen.add(at)
        return followers

    def _whole(self, values: dict[str, float], *, has_offset: bool) -> dict[str, float]:
        """Values of the free joints, and those of the joints that follow them, over other followers too."""
        found = dict(values)
        for name in self._followers:
            factor, offset, at = 1.0, 0.0, name
            while at in self._followers:
                mimic = self._followers[at]
                offset += factor * mimic.offset
                factor *= mimic.multiplier
                at = mimic.joint
            if at in values:
                found[name] = factor * values[at] + (offset if has_offset else 0.0)
        return found

    def _on_source(self, state: JointState) -> None:
        for values, given in (
            (self._positions, state.position),
            (self._velocities, state.velocity),
            (self._efforts, state.effort),
        ):
            if len(given) == len(state.name):
                values.update({n: v for n, v in zip(state.name, given, strict=True) if n in self._directions})

    def publish(self) -> None:
        """Publish one state, if the robot is known."""
        robot = self._robot
        if robot is None:
            return
        if self._delta:
            for name in self._positions:
                self._move(robot.joints[name])
        names = [n for n, joint in robot.joints.items() if joint.type in MOVING]
        message = JointState(name=names)
        message.header.stamp = self.get_clock().now().to_msg()
        for shown, field, values in (
            (self._has_positions, "position", self._whole(self._positions, has_offset=True)),
            (self._has_velocities, "velocity", self._whole(self._velocities, has_offset=False)),
            (self._has_efforts, "effort", self._efforts),
        ):
            if shown or (field != "position" and values):
                setattr(message, field, [values.get(name, 0.0) for name in names])
        if names:
            self._publisher.publish(message)

    def _move(self, joint: Joint) -> None:
        position = self._positions[joint.name] + self._delta * self._directions[joint.name]
        lower, upper = self._limits[joint.name]
        if not lower <= position <= upper:
            self._directions[joint.name] *= -1
            position = min(max(position, lower), upper)
        self._positions[joint.name] = position


def _middle(lower: float, upper: float) -> float:
    """Return 0, or the middle of limits that do not contain it."""
    is_inside = lower <= 0.0 <= upper or math.isnan(lower + upper)
    return 0.0 if is_inside else (lower + upper) / 2


def main(args: Sequence[str] | None = None) -> int:
    """Run the program: `[URDF FILE]`, else the robot is that of the topic /robot_description."""
    return run("joint_state_publisher", JointStatePublisher, args)


if __name__ == "__main__":
    sys.exit(main())

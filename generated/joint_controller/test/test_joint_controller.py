"""Tests of what the node joint_controller does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

import math
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from geometry_msgs.msg import WrenchStamped
from humanoid.data import JointCommand, Sensors
from humanoid.ros import messages
from humanoid.trials.harness import Lockstep
from joint_controller import _joint_controller_base as base
from joint_controller.joint_controller import JointController
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Float64MultiArray, String

PERIOD = 4_000_000  # ns


class Robot:
    """A robot that stands, as its sensors see it, and what is sent to its servos."""

    def __init__(self, ros: Any) -> None:
        self.sensors: Sensors = Lockstep().simulator.sensors()
        self.node = ros.start(JointController)
        self.node.trigger_configure()
        self.node.trigger_activate()
        peer = ros.peer
        self._command = peer.create_publisher(
            Float64MultiArray,
            "/whole_body_position_controller/commands",
            base.WHOLE_BODY_POSITION_CONTROLLER_COMMANDS_SUBSCRIPTION_QOS,
        )
        self._joints = peer.create_publisher(
            JointState, "/joint_encoders", base.JOINT_ENCODERS_SUBSCRIPTION_QOS
        )
        self._imu = peer.create_publisher(Imu, "/imu/data", base.IMU_DATA_SUBSCRIPTION_QOS)
        self._wrenches = [
            peer.create_publisher(WrenchStamped, f"/{side}_foot/wrench", base.L_FOOT_WRENCH_SUBSCRIPTION_QOS)
            for side in "lr"
        ]
        self.sent: list[JointState] = []
        self.reasons: list[str] = []
        peer.create_subscription(
            JointState, "/joint_commands", self.sent.append, base.JOINT_COMMANDS_PUBLISHER_QOS
        )
        peer.create_subscription(
            String,
            "/servos/standby",
            lambda message: self.reasons.append(message.data),
            base.SERVOS_STANDBY_PUBLISHER_QOS,
        )

    def read(self, stamp: int) -> None:
        """Publish the readings of a moment."""
        joints, imu = self.sensors.joints, self.sensors.imu
        joints.stamp = imu.stamp = stamp
        self._imu.publish(messages.imu(imu))
        for publisher, wrench in zip(self._wrenches, self.sensors.wrenches, strict=True):
            wrench.stamp = stamp
            publisher.publish(messages.wrench(wrench, "l_ankle"))
        self._joints.publish(messages.joint_states(joints))

    def command(self, stamp: int, *, spoilt: bool = False) -> None:
        """Command the posture that the robot has."""
        position = self.sensors.joints.position.copy()
        if spoilt:
            position[3] = math.nan
        self._command.publish(messages.command(JointCommand(stamp, position)))


def test_good_commands_pass_and_bad_ones_do_not(ros: Any) -> None:
    robot = Robot(ros)

    def tick() -> None:
        robot.read(PERIOD)
        robot.command(PERIOD)

    ros.deliver(tick, lambda: robot.sent, "set-points")
    assert list(robot.sent[-1].position) == list(robot.sensors.joints.position)
    assert robot.sent[-1].header.stamp.nanosec == PERIOD
    refusals = robot.node._gate.refusals
    ros.deliver(lambda: robot.command(2 * PERIOD, spoilt=True), lambda: refusals.not_finite, "refusal")
    assert {message.header.stamp.nanosec for message in robot.sent} == {PERIOD}
    assert all(math.isfinite(value) for message in robot.sent for value in message.position)


def test_a_bad_answer_to_the_newest_readings_lets_the_servos_keep_their_last_set_points(ros: Any) -> None:
    robot = Robot(ros)

    def tick(stamp: int, *, spoilt: bool = False) -> None:
        robot.read(stamp)
        robot.command(stamp, spoilt=spoilt)

    ros.deliver(lambda: tick(PERIOD), lambda: robot.sent, "set-points")
    ros.deliver(
        lambda: tick(2 * PERIOD, spoilt=True),
        lambda: robot.sent[-1].header.stamp.nanosec == 2 * PERIOD,
        "set-points for the second readings",
    )
    assert robot.sent[-1].position == robot.sent[0].position
    assert robot.node._gate.refusals.not_finite


def test_without_commands_it_stands_on_its_own(ros: Any) -> None:
    robot = Robot(ros)

    def tick() -> None:
        robot.read(PERIOD)
        robot.command(PERIOD)

    ros.deliver(tick, lambda: robot.sent, "set-points")
    later = 30 * PERIOD
    ros.deliver(lambda: robot.read(later), lambda: robot.reasons, "reason to stand on its own")
    assert robot.reasons == ["no good command for 0.12 s"]
    ros.spin_until(lambda: robot.sent[-1].header.stamp.nanosec == later, "set-points of its own")
    off = [abs(a - b) for a, b in zip(robot.sent[-1].position, robot.sensors.joints.position, strict=True)]
    assert max(off) < 0.3  # it stands where it stood

"""Tests of what the node joint_state_publisher does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from joint_state_publisher._joint_state_publisher_base import (
    JOINT_ENCODERS_SUBSCRIPTION_QOS,
    JOINT_STATES_PUBLISHER_QOS,
)
from joint_state_publisher.joint_state_publisher import JointStatePublisher
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

JOINTS = ["l_knee", "r_knee", "neck"]


def report(stamp: int, names: list[str], positions: list[float]) -> JointState:
    message = JointState(name=names, position=positions, velocity=positions, effort=positions)
    message.header.stamp.nanosec = stamp
    return message


def test_a_round_is_over_when_every_driver_has_reported(ros: Any) -> None:
    ros.start(JointStatePublisher, Parameter("joints", value=JOINTS))
    drivers = ros.peer.create_publisher(JointState, "/joint_encoders", JOINT_ENCODERS_SUBSCRIPTION_QOS)
    heard: list[JointState] = []
    ros.peer.create_subscription(JointState, "/joint_states", heard.append, JOINT_STATES_PUBLISHER_QOS)

    def both() -> None:
        drivers.publish(report(4, ["r_knee", "l_knee"], [0.2, 0.1]))
        drivers.publish(report(4, ["neck"], [0.3]))

    ros.deliver(both, lambda: heard, "message on /joint_states")
    assert heard[-1].header.stamp.nanosec == 4
    assert (heard[-1].name, list(heard[-1].position)) == (JOINTS, [0.1, 0.2, 0.3])
    assert list(heard[-1].velocity) == list(heard[-1].effort) == [0.1, 0.2, 0.3]
    count = len(heard)
    drivers.publish(report(8, ["neck"], [0.4]))
    assert not ros.spins_until(lambda: len(heard) > count, 0.2)
    drivers.publish(report(8, ["l_knee", "r_knee"], [0.5, 0.6]))
    ros.spin_until(lambda: heard[-1].header.stamp.nanosec == 8, "the next round")
    assert list(heard[-1].position) == [0.5, 0.6, 0.4]


def test_what_no_driver_should_say_is_refused(ros: Any) -> None:
    node = ros.start(JointStatePublisher, Parameter("joints", value=JOINTS))
    drivers = ros.peer.create_publisher(JointState, "/joint_encoders", JOINT_ENCODERS_SUBSCRIPTION_QOS)
    bad = (report(4, ["tail"], [0.1]), report(4, ["neck"], [0.1, 0.2]))
    for count, message in enumerate(bad, 1):
        ros.deliver(
            lambda message=message: drivers.publish(message),
            lambda count=count: node._health.counts["reports"] >= count,
            "refusal",
        )

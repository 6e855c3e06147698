"""Tests of what the node teleop does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from geometry_msgs.msg import Twist
from sensor_msgs.msg import Joy
from teleop._teleop_base import JOY_SUBSCRIPTION_QOS, TELEOP_VELOCITY_PUBLISHER_QOS
from teleop.teleop import Teleop

HELD, FORWARD = 4, 1  # numbers of a button and an axis


def joystick(forward: float, held: bool) -> Joy:
    joy = Joy(axes=[0.0] * 3, buttons=[0] * 5)
    joy.axes[FORWARD], joy.buttons[HELD] = forward, int(held)
    return joy


def test_the_dead_mans_button_steers_and_silence_stops(ros: Any) -> None:
    ros.start(Teleop)
    joy = ros.peer.create_publisher(Joy, "/joy", JOY_SUBSCRIPTION_QOS)
    heard: list[Twist] = []
    ros.peer.create_subscription(Twist, "/teleop/velocity", heard.append, TELEOP_VELOCITY_PUBLISHER_QOS)

    def push() -> None:
        joy.publish(joystick(1.0, held=True))
        ros.pass_time(0.1)

    ros.deliver(push, lambda: heard and heard[-1].linear.x == pytest.approx(0.4), "full speed")
    ros.deliver(lambda: ros.pass_time(0.1), lambda: not heard[-1].linear.x, "a stop")


def test_whoever_holds_no_joystick_leaves_the_robot_to_others(ros: Any) -> None:
    """Zeros of an idle joystick would keep everybody else from steering."""
    ros.start(Teleop)
    joy = ros.peer.create_publisher(Joy, "/joy", JOY_SUBSCRIPTION_QOS)
    heard: list[Twist] = []
    ros.peer.create_subscription(Twist, "/teleop/velocity", heard.append, TELEOP_VELOCITY_PUBLISHER_QOS)
    for _ in range(20):
        joy.publish(joystick(1.0, held=False))
        ros.pass_time(0.1)
    assert heard == []

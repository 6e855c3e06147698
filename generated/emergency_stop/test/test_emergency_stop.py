"""Tests of what the node emergency_stop does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from emergency_stop._emergency_stop_base import EMERGENCY_STOP_PUBLISHER_QOS, GAIT_STATE_SUBSCRIPTION_QOS
from emergency_stop.emergency_stop import EmergencyStop
from humanoid_interfaces.msg import EmergencyStop as Status
from humanoid_interfaces.msg import GaitState
from std_srvs.srv import SetBool


def test_the_button_is_latched_until_somebody_releases_it(ros: Any) -> None:
    node = ros.start(EmergencyStop)
    heard: list[Status] = []
    ros.peer.create_subscription(Status, "/emergency_stop", heard.append, EMERGENCY_STOP_PUBLISHER_QOS)
    name = node.resolve_service_name("~/set")
    assert ros.call(SetBool, name, SetBool.Request(data=True)).success
    ros.spin_until(lambda: heard, "the stop")
    assert (heard[-1].active, heard[-1].cause, heard[-1].source) == (True, Status.CAUSE_OPERATOR, "operator")
    assert ros.call(SetBool, name, SetBool.Request(data=False)).success
    ros.spin_until(lambda: not heard[-1].active, "the end of the stop")


def test_a_fall_stops_the_robot_and_cannot_be_released_while_it_lies(ros: Any) -> None:
    node = ros.start(EmergencyStop)
    heard: list[Status] = []
    ros.peer.create_subscription(Status, "/emergency_stop", heard.append, EMERGENCY_STOP_PUBLISHER_QOS)
    gait = ros.peer.create_publisher(GaitState, "/gait_state", GAIT_STATE_SUBSCRIPTION_QOS)
    fallen = GaitState(mode=GaitState.MODE_FALLEN)
    ros.deliver(lambda: gait.publish(fallen), lambda: heard and heard[-1].active, "the stop")
    assert heard[-1].cause == Status.CAUSE_FALL
    answer = ros.call(SetBool, node.resolve_service_name("~/set"), SetBool.Request(data=False))
    assert (answer.success, answer.message) == (False, "fall still requests the stop: the robot has fallen")
    assert heard[-1].active

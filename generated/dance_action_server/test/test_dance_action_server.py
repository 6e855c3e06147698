"""Tests of what the node dance_action_server does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from action_msgs.msg import GoalStatus
from dance_action_server import _dance_action_server_base as base
from dance_action_server.dance_action_server import DanceActionServer
from humanoid.ros import messages
from humanoid.trials.harness import Lockstep
from humanoid_interfaces.action import PerformDance
from humanoid_interfaces.msg import GaitState
from rclpy.action import ActionClient
from sensor_msgs.msg import JointState

TICK = 0.02  # s


def dancer(ros: Any) -> tuple[Any, Any]:
    """A client of a server whose robot stands; a function that lets time pass, and the robot report."""
    node = ros.start(DanceActionServer)
    peer = ros.peer
    gait = peer.create_publisher(GaitState, "/gait_state", base.GAIT_STATE_SUBSCRIPTION_QOS)
    joints = peer.create_publisher(JointState, "/joint_states", base.JOINT_STATES_SUBSCRIPTION_QOS)
    robot = Lockstep()
    robot.run(1.0)
    standing, posture = robot.controller.state(), robot.simulator.sensors().joints

    def report() -> None:
        ros.pass_time(TICK)
        standing.stamp = posture.stamp = int(node.get_clock().now().nanoseconds)
        gait.publish(messages.gait_state(standing))
        joints.publish(messages.joint_states(posture))

    client = ActionClient(peer, PerformDance, "/perform_dance")
    ros.spin_until(client.server_is_ready, "the dance server")
    ros.deliver(
        report, lambda: node._gait is not None and node._joints.get() is not None, "state of the robot"
    )
    return client, report


def test_a_cancelled_dance_ends_in_standing(ros: Any) -> None:
    client, report = dancer(ros)
    postures: list[JointState] = []
    ros.peer.create_subscription(JointState, "/posture", postures.append, base.POSTURE_PUBLISHER_QOS)
    sending = client.send_goal_async(PerformDance.Goal(dance="wave"))
    ros.deliver(report, sending.done, "answer to the goal")
    handle = sending.result()
    assert handle.accepted
    ros.deliver(report, lambda: postures and postures[-1].name, "posture")
    cancelling = handle.cancel_goal_async()
    ending = handle.get_result_async()
    ros.spin_until(cancelling.done, "answer to the cancellation")
    ros.deliver(report, ending.done, "end of the dance")
    assert ros.result(ending, "result").status == GoalStatus.STATUS_CANCELED
    ros.spin_until(lambda: not postures[-1].name, "the standing posture")


def test_a_dance_that_nobody_knows_is_rejected(ros: Any) -> None:
    client, report = dancer(ros)
    sending = client.send_goal_async(PerformDance.Goal(dance="polka"))
    ros.deliver(report, sending.done, "answer to the goal")
    assert not sending.result().accepted

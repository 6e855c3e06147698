"""Tests of what the node whole_body_controller does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")
pytest.importorskip("mujoco", reason="the controller needs MuJoCo")

from humanoid.ros import messages
from humanoid.trials.harness import Lockstep
from humanoid_interfaces.msg import BalanceState, GaitState
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Float64MultiArray
from whole_body_controller import _whole_body_controller_base as base
from whole_body_controller.whole_body_controller import WholeBodyController


def test_it_answers_the_readings_of_a_moment_with_set_points(ros: Any) -> None:
    simulator = Lockstep().simulator
    ros.start(WholeBodyController)
    commands: list[Float64MultiArray] = []
    states: list[GaitState] = []
    balances: list[BalanceState] = []
    peer = ros.peer
    peer.create_subscription(
        Float64MultiArray,
        "/whole_body_position_controller/commands",
        commands.append,
        base.WHOLE_BODY_POSITION_CONTROLLER_COMMANDS_PUBLISHER_QOS,
    )
    peer.create_subscription(GaitState, "/gait_state", states.append, base.GAIT_STATE_PUBLISHER_QOS)
    peer.create_subscription(
        BalanceState, "/whole_body_controller/balance", balances.append, base.BALANCE_PUBLISHER_QOS
    )
    joints = peer.create_publisher(JointState, "/joint_states", base.JOINT_STATES_SUBSCRIPTION_QOS)
    imu = peer.create_publisher(Imu, "/imu/data", base.IMU_DATA_SUBSCRIPTION_QOS)
    odometry = peer.create_publisher(Odometry, "/odom", base.ODOM_SUBSCRIPTION_QOS)
    readings, truth = simulator.sensors(), simulator.truth()

    def moment() -> None:
        joints.publish(messages.joint_states(readings.joints))
        imu.publish(messages.imu(readings.imu))
        odometry.publish(messages.odometry(truth))

    ros.deliver(moment, lambda: commands and states and balances, "set-points, gait state and balance")
    command = messages.read_command(commands[0], -1)
    assert (command.stamp, command.answers) == (0, True)
    assert max(abs(command.position - readings.joints.position)) < 0.3  # it stands where it stands
    assert states[0].mode in {GaitState.MODE_STANDING, GaitState.MODE_STOPPING}
    assert states[0].reason == ""
    assert len(balances[0].support.points) == 4  # both soles
    assert abs(balances[0].capture_point.y) < 0.01

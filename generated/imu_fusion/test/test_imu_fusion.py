"""Tests of what the node imu_fusion does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")
pytest.importorskip("mujoco", reason="the estimator needs MuJoCo")

from geometry_msgs.msg import WrenchStamped
from humanoid.ros import messages
from humanoid.trials.harness import Lockstep
from imu_fusion import _imu_fusion_base as base
from imu_fusion.imu_fusion import ImuFusion
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState


def test_it_estimates_once_all_readings_of_a_moment_are_there(ros: Any) -> None:
    simulator = Lockstep().simulator
    node = ros.start(ImuFusion)
    heard: list[Odometry] = []
    peer = ros.peer
    peer.create_subscription(Odometry, "/odom", heard.append, base.ODOM_PUBLISHER_QOS)
    joints = peer.create_publisher(JointState, "/joint_states", base.JOINT_STATES_SUBSCRIPTION_QOS)
    imu = peer.create_publisher(Imu, "/imu/data", base.IMU_DATA_SUBSCRIPTION_QOS)
    wrenches = [
        peer.create_publisher(WrenchStamped, f"/{side}_foot/wrench", base.L_FOOT_WRENCH_SUBSCRIPTION_QOS)
        for side in "lr"
    ]
    readings = simulator.sensors()

    def most() -> None:
        joints.publish(messages.joint_states(readings.joints))
        wrenches[0].publish(messages.wrench(readings.wrenches[0], "l_ankle"))
        imu.publish(messages.imu(readings.imu))

    ros.deliver(most, lambda: node._imu.has(0) and node._joints.has(0), "readings")
    assert heard == []
    last = messages.wrench(readings.wrenches[1], "r_ankle")
    ros.deliver(lambda: (most(), wrenches[1].publish(last)), lambda: heard, "odometry")
    estimated, true = heard[-1].pose.pose.position, simulator.truth().position
    assert (estimated.x, estimated.y, estimated.z) == pytest.approx(true.tolist(), abs=0.005)

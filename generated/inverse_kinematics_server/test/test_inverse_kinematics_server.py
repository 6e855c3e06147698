"""Tests of what the node inverse_kinematics_server does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")
pytest.importorskip("mujoco", reason="the kinematics need MuJoCo")

from geometry_msgs.msg import Point, Pose, PoseStamped
from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from inverse_kinematics_server.inverse_kinematics_server import InverseKinematicsServer
from sensor_msgs.msg import JointState

HAND = Point(x=0.3, y=0.2, z=0.1)  # of the left one, in base_link, within its reach


def request(position: Point, chain: str = "left_arm") -> SolveIK.Request:
    target = PoseStamped(pose=Pose(position=position))
    target.header.frame_id = "base_link"
    return SolveIK.Request(chain=chain, target=target, position_only=True, seed=JointState())


def test_a_hand_reaches_a_point_in_front_of_it(ros: Any) -> None:
    ros.start(InverseKinematicsServer, use_sim_time=False)
    answer = ros.call(SolveIK, "/solve_ik", request(HAND))
    assert (answer.status, answer.message) == (SolveIK.Response.STATUS_SOLVED, "")
    assert answer.position_residual < 0.002
    assert "l_elbow" in answer.solution.name


@pytest.mark.parametrize(
    ("asked", "status"),
    [
        (request(Point(x=3.0)), SolveIK.Response.STATUS_UNREACHABLE),
        (request(HAND, "tail"), SolveIK.Response.STATUS_UNKNOWN_CHAIN),
        (request(Point(x=float("nan"))), SolveIK.Response.STATUS_INVALID_REQUEST),
    ],
)
def test_what_cannot_be_reached_is_said(ros: Any, asked: SolveIK.Request, status: int) -> None:
    ros.start(InverseKinematicsServer, use_sim_time=False)
    answer = ros.call(SolveIK, "/solve_ik", asked)
    assert answer.status == status
    assert answer.message


def test_the_head_looks_ahead_and_not_at_the_sky(ros: Any) -> None:
    ros.start(InverseKinematicsServer, use_sim_time=False)

    def reachable(x: float, z: float) -> bool:
        target = PoseStamped(pose=Pose(position=Point(x=x, z=z)))
        target.header.frame_id = "base_link"
        asked = CheckHeadPose.Request(mode=CheckHeadPose.Request.MODE_LOOK_AT, target=target)
        return bool(ros.call(CheckHeadPose, "/check_head_pose", asked).reachable)

    assert (reachable(2.0, 0.5), reachable(0.1, 9.0)) == (True, False)

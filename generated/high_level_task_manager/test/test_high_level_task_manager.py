"""Tests of what the node high_level_task_manager does.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from high_level_task_manager import _high_level_task_manager_base as base
from high_level_task_manager.high_level_task_manager import HighLevelTaskManager
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import EmergencyStop, GaitState, TaskStatus
from humanoid_interfaces.srv import CheckHeadPose, SolveIK
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import String


class Robot:
    """A robot that stands, its servers, and what the task manager says of its tasks."""

    def __init__(self, ros: Any, *tasks: str) -> None:
        self.ros = ros
        self.danced: list[str] = []
        ros.serve_action(PerformDance, "/perform_dance", self.dance)
        ros.serve_action(WalkTo, "/walk_to")
        ros.start(HighLevelTaskManager, Parameter("tasks", value=list(tasks)))
        self.told: list[TaskStatus] = []
        ros.peer.create_subscription(
            TaskStatus, "/high_level_task_manager/task", self.told.append, base.TASK_PUBLISHER_QOS
        )
        self.gait = ros.peer.create_publisher(GaitState, "/gait_state", base.GAIT_STATE_SUBSCRIPTION_QOS)
        self.speech = ros.peer.create_publisher(String, "/speech/text", base.SPEECH_TEXT_SUBSCRIPTION_QOS)

    def dance(self, handle: Any) -> PerformDance.Result:
        self.danced.append(handle.request.dance)
        handle.succeed()
        return PerformDance.Result(completed=True, beats=8)

    def tick(self) -> None:
        """Let a moment pass, in which the robot stands."""
        self.gait.publish(GaitState(mode=GaitState.MODE_STANDING))
        self.ros.pass_time(0.1)

    def until(self, state: int, number: int) -> TaskStatus:
        """Wait for a state of a task."""

        def found() -> TaskStatus | None:
            return next((t for t in self.told if (t.state, t.number) == (state, number)), None)

        self.ros.deliver(self.tick, found, f"state {state} of task {number}")
        status = found()
        assert status is not None
        return status


def test_it_does_its_tasks_and_what_it_is_told(ros: Any) -> None:
    robot = Robot(ros, "dance waltz", "wait 0.3")
    assert robot.until(TaskStatus.STATE_SUCCEEDED, 1).message == "8 beats"
    assert robot.until(TaskStatus.STATE_RUNNING, 2).words == "wait 0.3"
    assert robot.until(TaskStatus.STATE_IDLE, 2).waiting == 0
    robot.speech.publish(String(data="dance disco"))
    robot.until(TaskStatus.STATE_SUCCEEDED, 3)
    assert robot.danced == ["waltz", "disco"]


def test_it_points_and_looks_where_the_kinematics_say(ros: Any) -> None:
    asked: list[Any] = []

    def look(request: CheckHeadPose.Request, response: CheckHeadPose.Response) -> CheckHeadPose.Response:
        asked.append(request)
        response.reachable, response.joints = True, JointState(name=["head_yaw"], position=[0.1])
        return response

    def reach(request: SolveIK.Request, response: SolveIK.Response) -> SolveIK.Response:
        asked.append(request)
        response.status = SolveIK.Response.STATUS_SOLVED
        response.solution = JointState(name=["l_elbow"], position=[-0.7])
        return response

    ros.serve(CheckHeadPose, "/check_head_pose", look)
    ros.serve(SolveIK, "/solve_ik", reach)
    postures: list[JointState] = []
    ros.peer.create_subscription(JointState, "/posture", postures.append, base.POSTURE_PUBLISHER_QOS)
    robot = Robot(ros, "point 2 0.4 1.3 for 0.5")
    robot.until(TaskStatus.STATE_SUCCEEDED, 1)
    gaze, hand = asked
    assert (gaze.target.header.frame_id, gaze.target.pose.position.x) == ("base_footprint", 2.0)
    assert (hand.chain, list(hand.seed.name)) == ("left_arm", ["head_yaw"])
    ros.spin_until(lambda: postures and not postures[-1].name, "the standing posture")
    assert next(list(p.name) for p in postures if p.name) == ["head_yaw", "l_elbow"]


def test_what_is_no_task_is_not_done(ros: Any) -> None:
    robot = Robot(ros, "fly", "wait 0.1")
    assert robot.until(TaskStatus.STATE_SUCCEEDED, 1).words == "wait 0.1"


def test_stop_all_drops_what_waits(ros: Any) -> None:
    robot = Robot(ros, "wait 100", "dance waltz")
    robot.until(TaskStatus.STATE_RUNNING, 1)
    robot.speech.publish(String(data="stop all"))
    assert robot.until(TaskStatus.STATE_CANCELED, 1).waiting == 0
    robot.until(TaskStatus.STATE_IDLE, 1)
    assert robot.danced == []


def test_an_emergency_stop_drops_what_waits(ros: Any) -> None:
    robot = Robot(ros, "wait 100", "dance waltz")
    stop = ros.peer.create_publisher(EmergencyStop, "/emergency_stop", base.EMERGENCY_STOP_SUBSCRIPTION_QOS)
    robot.until(TaskStatus.STATE_RUNNING, 1)
    stop.publish(EmergencyStop(active=True, reason="a test"))
    robot.until(TaskStatus.STATE_CANCELED, 1)
    robot.until(TaskStatus.STATE_IDLE, 1)
    assert robot.danced == []

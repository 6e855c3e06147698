"""Unreachable goals are rejected or aborted with the reason; a second goal is treated as its policy says."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped, Quaternion
from humanoid.data import Mode
from humanoid.robot.scene import FACE_POSITION
from humanoid.ros import messages
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import Stance
from humanoid_interfaces.srv import PlanFootsteps, SolveIK

from tests.humanoid.graph.robot import MOTION, PLANNING, WALKING, Robot, walk

MakeRobot = Callable[..., Robot]
NAN = math.nan
BEHIND_THE_BOARD = (FACE_POSITION[0] + 1.0, FACE_POSITION[1], 0.0)


def standing(make_robot: MakeRobot, *names: str, **parameters: Any) -> Robot:
    robot = make_robot(*names, **parameters)
    robot.until(lambda: robot.mode is Mode.STANDING)
    return robot


def test_walks_that_cannot_be_walked_are_rejected_with_the_reason(make_robot: MakeRobot) -> None:
    robot = make_robot("navigation_action_server", *PLANNING, "humanoid_simulator")
    assert not robot.send(walk(0.3)).accepted
    robot.expect(
        "navigation_action_server", "rejected: the controller has not reported yet where the feet are"
    )
    for name in MOTION[1:]:
        robot.start(name)
    robot.until(lambda: robot.mode is Mode.STANDING)
    tilted = walk(0.5)
    tilted.target.pose.orientation = Quaternion(x=NAN, w=1.0)
    for goal, words in (
        (
            walk(15.0, 15.0, max_step_length=0.03),
            "the goal is 21.2 m away: more than the 512 steps that a plan can hold",
        ),
        (walk(70.0, 15.0), "the goal (70.00, 15.00) is off the floor, which ends at 20 m"),
        (walk(NAN), "the goal holds a number that is not finite"),
        (walk(0.5, math.inf), "the goal holds a number that is not finite"),
        (tilted, "the goal holds a number that is not finite"),
        (walk(0.5, frame="moon"), "the goal is in 'moon'; I walk in odom"),
        (walk(0.5, max_step_length=NAN), "max_step_length is nan m; it must be finite, 0 or more"),
        (walk(0.5, max_step_length=-0.1), "max_step_length is -0.1 m; it must be finite, 0 or more"),
        (walk(0.5, position_tolerance=NAN), "tolerances must be finite and above 0"),
        (walk(0.5, yaw_tolerance=-1.0), "tolerances must be finite and above 0"),
        (walk(*FACE_POSITION[:2]), "from an obstacle; I keep 0.4 m"),
    ):
        robot.log.clear()
        handle = robot.send(goal)
        if handle.accepted:
            status, result = robot.result(handle)
            assert status == GoalStatus.STATUS_ABORTED
            assert words in result.message
            robot.expect("navigation_action_server", f"goal aborted: {words}")
        else:
            robot.expect("navigation_action_server", "goal rejected: ")
            assert robot.said("navigation_action_server", words), robot.log
    assert robot.mode is Mode.STANDING
    status, result = robot.result(robot.send(walk(*BEHIND_THE_BOARD)))  # there is a way round
    assert status == GoalStatus.STATUS_SUCCEEDED, result.message


def test_dances_plans_and_arms_that_cannot_be(make_robot: MakeRobot) -> None:
    more = ("dance_action_server", "footstep_generation_server", "inverse_kinematics_server")
    robot = standing(make_robot, *MOTION, *more)
    for goal, words in (
        (PerformDance.Goal(dance="tango"), "there is no dance 'tango'; I know disco, waltz, wave"),
        (PerformDance.Goal(), "there is no dance ''"),
        (PerformDance.Goal(dance="wave", tempo=NAN), "nan beats per minute cannot be danced"),
        (PerformDance.Goal(dance="wave", tempo=900.0), "900 beats per minute cannot be danced"),
    ):
        assert not robot.send(goal).accepted
        robot.expect("dance_action_server", f"goal rejected: {words}")
    start = Stance(support=Stance.SUPPORT_BOTH, left_sole=messages.planar_pose(0, 0.09, 0))
    start.right_sole = messages.planar_pose(0, -0.09, 0)
    for x, first_leg, status, words in (
        (3.0, 0, PlanFootsteps.Response.STATUS_BLOCKED, "is occupied by the board with the face"),
        (NAN, 0, PlanFootsteps.Response.STATUS_INVALID_REQUEST, "not finite"),
        (1.0, 9, PlanFootsteps.Response.STATUS_INVALID_REQUEST, "there is no leg 9"),
    ):
        goal = PoseStamped(pose=messages.planar_pose(x, -0.9, 0.0))
        request = PlanFootsteps.Request(start=start, goal=goal, first_leg=first_leg)
        answer = robot.call(PlanFootsteps, "/plan_footsteps", request)
        assert (answer.status, words in answer.message, len(answer.plan.steps)) == (status, True, 0)
    for x in (5.0, NAN):
        target = PoseStamped(header=messages.header(0, "base_link"), pose=messages.planar_pose(x, 0.3, 0.0))
        answer = robot.call(SolveIK, "/solve_ik", SolveIK.Request(chain="left_arm", target=target))
        assert answer.status not in {SolveIK.Response.STATUS_UNKNOWN, SolveIK.Response.STATUS_SOLVED}
        assert answer.message
    assert robot.mode is Mode.STANDING


@pytest.mark.parametrize("policy", ["preempt", pytest.param("reject", marks=pytest.mark.slow)])
def test_a_second_walk(make_robot: MakeRobot, policy: str) -> None:
    robot = standing(make_robot, *WALKING, navigation_action_server={"second_goal": policy})
    first = robot.send(walk(0.6))
    robot.run(2.0)
    second = robot.send(walk(0.3, 0.1))
    if policy == "preempt":
        assert second.accepted
        status, result = robot.result(first)
        assert (status, result.outcome) == (GoalStatus.STATUS_ABORTED, WalkTo.Result.OUTCOME_PREEMPTED)
        assert result.message == "a later goal took over"
    else:
        assert not second.accepted
        robot.expect("navigation_action_server", "goal rejected: I am already walking to another goal")
    status, _ = robot.result(second if policy == "preempt" else first)
    assert status == GoalStatus.STATUS_SUCCEEDED
    wanted = (0.3, 0.1) if policy == "preempt" else (0.6, 0.0)
    assert np.hypot(*robot.physics.sole_truth().centre[:2] - wanted) < 0.06
    assert not robot.fell


@pytest.mark.parametrize("policy", [pytest.param("preempt", marks=pytest.mark.slow), "reject"])
def test_a_second_dance(make_robot: MakeRobot, policy: str) -> None:
    robot = standing(make_robot, *MOTION, "dance_action_server", dance_action_server={"second_goal": policy})
    first = robot.send(PerformDance.Goal(dance="wave"))
    robot.run(2.0)
    second = robot.send(PerformDance.Goal(dance="wave", beats=2))
    assert second.accepted == (policy == "preempt")
    if policy == "preempt":
        status, result = robot.result(first)
        assert (status, result.completed) == (GoalStatus.STATUS_ABORTED, False)
        assert result.message == "a later goal took over"
        status, result = robot.result(second)
        assert (status, result.beats) == (GoalStatus.STATUS_SUCCEEDED, 2)
    else:
        robot.expect("dance_action_server", "goal rejected: I am dancing already")
        assert robot.get(first.cancel_goal_async()).goals_canceling
        status, result = robot.result(first)
        assert (status, result.message) == (GoalStatus.STATUS_CANCELED, "canceled")
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert not robot.fell


@pytest.mark.slow
def test_goals_that_are_cancelled_while_others_take_over(make_robot: MakeRobot) -> None:
    robot = standing(make_robot, *WALKING)
    first = robot.send(walk(1.5))
    robot.run(2.0)
    cancelling = first.cancel_goal_async()
    second = robot.send(walk(0.4, 0.2, 0.5))  # arrives while the first one is being cancelled
    robot.get(cancelling)
    assert robot.result(first)[0] in {GoalStatus.STATUS_ABORTED, GoalStatus.STATUS_CANCELED}
    third = robot.send(walk(1.5, -0.3))
    assert robot.result(second)[1].outcome == WalkTo.Result.OUTCOME_PREEMPTED
    robot.run(1.0)
    began = robot.now
    robot.get(third.cancel_goal_async())
    status, result = robot.result(third)
    assert (status, result.outcome) == (GoalStatus.STATUS_CANCELED, WalkTo.Result.OUTCOME_CANCELED)
    assert robot.now - began < 2.5
    fourth = robot.send(walk(0.3))
    assert robot.result(fourth)[0] == GoalStatus.STATUS_SUCCEEDED
    assert np.hypot(*robot.physics.sole_truth().centre[:2] - [0.3, 0.0]) < 0.06
    assert not robot.fell

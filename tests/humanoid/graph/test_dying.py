"""Nodes that die while the robot walks: it stands within two seconds, some node says why, and a node may return."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Twist, Vector3
from humanoid.data import Mode, Support
from humanoid_interfaces.action import PerformDance, WalkTo
from std_srvs.srv import Trigger

from tests.humanoid.graph.robot import MOTION, WALKING, Robot, walk

MakeRobot = Callable[..., Robot]
ON_THE_GROUND = 0.008  # m
SAFE_WITHIN = 2.0  # s, where one more step must catch a fast walk


def walking(make_robot: MakeRobot, seconds: float, *more: str, **parameters: Any) -> tuple[Robot, Any]:
    robot = make_robot(*WALKING, *more, **parameters)
    robot.run(0.5)
    goal = robot.send(walk(2.0, 0.6, 1.0))
    assert goal.accepted
    robot.run(seconds)
    assert robot.mode is Mode.WALKING
    return robot, goal


def both_feet_down_after(robot: Robot, watched: float = SAFE_WITHIN + 1.0) -> float:
    """Seconds until both soles are on the floor, where they stay for the time `watched` [s]."""
    began, down = robot.now, 0.0
    while robot.now < began + watched:
        robot.run(0.004)
        assert not robot.fell
        if robot.height_of_feet() > ON_THE_GROUND:
            down = robot.now - began
    assert robot.physics.sole_truth().support is Support.BOTH
    return down


def comes_back(robot: Robot, node: str) -> None:
    """Restart a node: the robot accepts goals again, and does nothing before it receives one."""
    feet = robot.physics.sole_truth().feet
    robot.start(node)
    robot.until(lambda: robot.now > 60 or (robot.mode is Mode.STANDING and not robot.standby))
    robot.run(1.0)
    assert np.allclose(robot.physics.sole_truth().feet[0], feet[0], atol=0.02)
    assert np.allclose(robot.physics.sole_truth().feet[1], feet[1], atol=0.02)
    centre = robot.physics.sole_truth().centre
    x, y, yaw = (float(part) for part in centre)
    status, result = robot.result(robot.send(walk(x + 0.3 * np.cos(yaw), y + 0.3 * np.sin(yaw), yaw)))
    assert (status, result.outcome) == (GoalStatus.STATUS_SUCCEEDED, WalkTo.Result.OUTCOME_REACHED), result
    moved = np.hypot(*(robot.physics.sole_truth().centre - centre)[:2])
    assert abs(moved - 0.3) < 0.06
    assert not robot.fell


@pytest.mark.parametrize(
    ("node", "says", "words"),
    [
        ("gait_planner", "whole_body_controller", "gait_planner has been silent for 0.10 s"),
        pytest.param(
            "imu_fusion",
            "whole_body_controller",
            "no odometry from imu_fusion for 0.05 s",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "whole_body_controller",
            "joint_controller",
            "the servos hold the robot on their own: no good command for 0.0",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_node_dies_in_a_step_and_comes_back(
    make_robot: MakeRobot, node: str, says: str, words: str
) -> None:
    robot, goal = walking(make_robot, 2.35)
    reports: dict[str, DiagnosticStatus] = {}
    robot.listen(DiagnosticArray, "/diagnostics", lambda m: reports.update((s.name, s) for s in m.status))
    assert robot.height_of_feet() > 0.02
    robot.kill(node)
    assert both_feet_down_after(robot) <= SAFE_WITHIN
    robot.expect(says, words)
    if node != "whole_body_controller":
        assert robot.mode is Mode.HOLDING
        assert robot.gait.reason == words
    status, result = robot.result(goal)
    assert (status, result.outcome) == (GoalStatus.STATUS_ABORTED, WalkTo.Result.OUTCOME_STOPPED)
    assert node in result.message
    assert "silent" in result.message or "no odometry" in result.message
    (report,) = [report for name, report in reports.items() if name.startswith(says)]
    assert report.level == DiagnosticStatus.ERROR
    comes_back(robot, node)


@pytest.mark.slow
def test_without_navigation_the_robot_stops_and_whoever_waits_is_told(make_robot: MakeRobot) -> None:
    tasks = {"tasks": ["walk 2.0 0.0 0.0", "wait 1"]}
    robot = make_robot(*WALKING, "high_level_task_manager", high_level_task_manager=tasks)
    robot.until(lambda: robot.mode is Mode.WALKING)
    robot.run(2.0)
    robot.kill("navigation_action_server")
    began = robot.now
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert robot.now - began < 0.5 + 2.5
    robot.expect(
        "gait_planner", "navigation_action_server, or whoever sent the plan under way, has been silent"
    )
    robot.expect("high_level_task_manager", "walk 2 0 0: navigation_action_server has been silent for 2 s")
    robot.start("navigation_action_server")  # the task's second attempt finds it
    robot.until(lambda: robot.mode is Mode.WALKING)


@pytest.mark.slow
def test_without_the_footstep_server_a_walk_ends_and_no_other_begins(make_robot: MakeRobot) -> None:
    robot = make_robot(*WALKING)
    robot.run(0.5)
    goal = robot.send(walk(0.3))
    robot.run(0.5)
    robot.kill("footstep_generation_server")
    status, _ = robot.result(goal)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert not robot.send(walk(0.6)).accepted
    robot.expect("navigation_action_server", "goal rejected: there is no service '/plan_footsteps'")


@pytest.mark.slow
def test_a_plan_that_nobody_walks_is_given_up(make_robot: MakeRobot) -> None:
    robot = make_robot(*WALKING)
    robot.run(0.5)
    robot.kill("gait_planner")
    status, result = robot.result(robot.send(walk(0.5)))
    assert status == GoalStatus.STATUS_ABORTED
    assert "gait_planner is silent" in result.message
    assert robot.mode is Mode.STANDING


def test_silence_stops_who_is_steered_by_hand(make_robot: MakeRobot) -> None:
    robot = make_robot(*MOTION)
    robot.run(0.5)
    steer = robot.publisher(Twist, "/humanoid/cmd_vel", 1)
    for _ in range(20):
        steer(Twist(linear=Vector3(x=0.15)))
        robot.run(0.1)
    assert robot.mode is Mode.WALKING
    began = robot.now
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert robot.now - began < 0.5 + 2.5
    robot.expect("gait_planner", "teleop, or whoever sent velocities, has been silent for 0.5 s")


@pytest.mark.slow
def test_a_dance_that_is_not_danced_on_ends_in_standing(make_robot: MakeRobot) -> None:
    robot = make_robot(*MOTION, "dance_action_server")
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert robot.send(PerformDance.Goal(dance="wave")).accepted
    robot.run(2.0)
    assert robot.mode is Mode.DANCING
    robot.kill("dance_action_server")
    robot.run(0.6)
    assert robot.mode is Mode.STANDING
    robot.expect("whole_body_controller", "whoever sent postures is silent")


@pytest.mark.slow
def test_the_simulator_restarts_in_the_middle_of_a_walk(make_robot: MakeRobot) -> None:
    robot, goal = walking(make_robot, 2.35, "teleop", "emergency_stop")
    assert robot.call(Trigger, "/humanoid_simulator/reset", Trigger.Request()).success
    status, result = robot.result(goal)
    assert (status, result.message) == (GoalStatus.STATUS_ABORTED, "the simulation has started again")
    robot.run(1.5)
    assert robot.mode is Mode.STANDING
    assert np.hypot(*robot.physics.sole_truth().centre[:2]) < 0.01
    status, _ = robot.result(robot.send(walk(0.2)))
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert abs(robot.physics.sole_truth().centre[0] - 0.2) < 0.06


@pytest.mark.slow
@pytest.mark.parametrize("node", ["gait_planner", "imu_fusion", "whole_body_controller"])
def test_a_node_dies_at_any_moment(make_robot: MakeRobot, node: str) -> None:
    random = np.random.default_rng(11)
    times = []
    for seed in range(8):
        robot, _ = walking(make_robot, float(random.uniform(1.3, 7.0)), humanoid_simulator={"seed": seed})
        robot.kill(node)
        times.append(both_feet_down_after(robot, watched=2.5))
        robot.close()
    assert max(times) <= SAFE_WITHIN, times

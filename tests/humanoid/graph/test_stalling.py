"""A machine that is too busy for a while: messages get lost, and commands stall."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from humanoid.data import Mode

from tests.humanoid.graph.robot import WALKING, Robot, walk

MakeRobot = Callable[..., Robot]
LOST = 0.05  # share of the messages of each topic


def lose(node: Any, publish: str, choose: Callable[[], bool]) -> Callable[[], None]:
    """Lose messages that a node publishes; returns a function that ends it."""
    send = getattr(node, publish)
    setattr(node, publish, lambda message: choose() or send(message))
    return lambda: setattr(node, publish, send)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_lost_readings_and_commands_do_no_harm(make_robot: MakeRobot, seed: int) -> None:
    robot = make_robot(*WALKING, humanoid_simulator={"patience": 0.01, "seed": seed})
    random = np.random.default_rng(seed)
    robot.run(1.0)
    simulator, controller = robot.nodes["humanoid_simulator"], robot.nodes["whole_body_controller"]
    for name in ("joint_encoders", "imu_data", "l_foot_wrench", "r_foot_wrench"):
        lose(simulator, f"publish_{name}", lambda: random.random() < LOST)
    for name, publish in (
        ("joint_state_publisher", "publish_joint_states"),
        ("imu_fusion", "publish_odom"),
        ("joint_controller", "publish_joint_commands"),
    ):
        lose(robot.nodes[name], publish, lambda: random.random() < LOST)
    lose(controller, "publish_whole_body_position_controller_commands", lambda: random.random() < LOST)
    goal = robot.send(walk(0.5, 0.2, 0.6))
    status, result = robot.result(goal)
    assert status == GoalStatus.STATUS_SUCCEEDED, result.message
    assert not robot.fell


def test_after_a_stall_of_commands_everybody_knows_and_the_robot_walks_again(make_robot: MakeRobot) -> None:
    robot = make_robot(*WALKING, navigation_action_server={"recovery_time": 0.0})
    robot.run(1.0)
    goal = robot.send(walk(1.0))
    robot.until(lambda: robot.gait.footstep_index >= 2)
    controller = robot.nodes["whole_body_controller"]
    resume = lose(controller, "publish_whole_body_position_controller_commands", lambda: True)
    robot.run(0.2)
    resume()
    status, result = robot.result(goal)
    assert status == GoalStatus.STATUS_ABORTED
    assert "the servos hold the robot on their own: no good command" in result.message
    assert robot.mode is Mode.HOLDING
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert robot.standby == ""
    status, _ = robot.result(robot.send(walk(0.4, 0.2)))
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert not robot.fell


@pytest.mark.slow
def test_a_walk_goes_on_after_stalls(make_robot: MakeRobot) -> None:
    robot = make_robot(*WALKING)
    robot.run(1.0)
    goal = robot.send(walk(1.0))
    held = []
    controller = robot.nodes["whole_body_controller"]
    for step in (2, 4):
        robot.until(lambda step=step: robot.gait.footstep_index >= step)
        resume = lose(controller, "publish_whole_body_position_controller_commands", lambda: True)
        robot.run(0.2)
        resume()
        robot.until(lambda: robot.mode is Mode.HOLDING)
        held.append(robot.gait.reason)
    status, result = robot.result(goal)
    assert status == GoalStatus.STATUS_SUCCEEDED, result.message
    assert all("no good command" in reason for reason in held)
    assert not robot.fell


@pytest.mark.parametrize(
    ("node", "publish"),
    [
        ("joint_state_publisher", "publish_joint_states"),
        ("imu_fusion", "publish_odom"),
        ("whole_body_controller", "publish_whole_body_position_controller_commands"),
        ("joint_controller", "publish_joint_commands"),
    ],
)
def test_time_begins_though_the_first_answers_get_lost(
    make_robot: MakeRobot, node: str, publish: str
) -> None:
    """As on real rclpy while nodes are still discovering each other."""
    robot = make_robot("humanoid_simulator", humanoid_simulator={"patience": 0.05})
    for name in WALKING[1:]:
        robot.start(name)
    answers = iter(range(5))
    lose(robot.nodes[node], publish, lambda: next(answers, None) is not None)
    robot.run(0.5)
    assert next(answers, None) is None
    assert robot.standby == ""

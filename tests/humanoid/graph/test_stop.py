"""The emergency stop overrides every other command, whenever nodes start, until nobody requests it any longer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Twist, Vector3
from humanoid.data import Footstep, Leg, Mode, Posture
from humanoid.data import FootstepPlan as Plan
from humanoid.planning.choreography import standing_posture
from humanoid.ros import messages
from humanoid_interfaces.action import PerformDance, WalkTo
from humanoid_interfaces.msg import BatteryStatus, EmergencyStop, FootstepPlan, TaskStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import SetBool

from tests.humanoid.graph.robot import LATCHED, WALKING, Robot, walk

MakeRobot = Callable[..., Robot]
EVERYBODY = (*WALKING, "dance_action_server", "high_level_task_manager", "emergency_stop")
PRESSED = "operator: the button was pressed"


def press(robot: Robot, *, down: bool) -> Any:
    return robot.call(SetBool, "/emergency_stop/set", SetBool.Request(data=down))


def assert_goals_are_refused(robot: Robot) -> None:
    assert not robot.send(walk(0.3)).accepted
    robot.expect("navigation_action_server", "goal rejected: emergency stop: the button was pressed")
    assert not robot.send(PerformDance.Goal(dance="wave")).accepted
    robot.expect("dance_action_server", "goal rejected: emergency stop: the button was pressed")


def test_it_ends_a_step_and_everything_else(make_robot: MakeRobot) -> None:
    robot = make_robot(*EVERYBODY)
    robot.until(lambda: robot.mode is Mode.STANDING)
    goal = robot.send(walk(2.0, 0.6, 1.0))
    robot.run(2.35)
    assert robot.height_of_feet() > 0.02
    assert press(robot, down=True).success
    began = robot.now
    robot.until(lambda: robot.height_of_feet() < 0.008)
    assert robot.now - began <= 0.5
    status, result = robot.result(goal)
    assert status == GoalStatus.STATUS_ABORTED
    assert (result.outcome, result.message) == (WalkTo.Result.OUTCOME_STOPPED, PRESSED)
    assert_goals_are_refused(robot)
    everybody_commands(robot)
    assert robot.mode is Mode.EMERGENCY_STOP
    assert robot.gait.reason == PRESSED
    assert robot.physics.gate.refusals.total == 0  # the servos could follow the landing
    assert not robot.fell
    assert press(robot, down=False).success
    robot.until(lambda: robot.mode is Mode.STANDING)
    feet = robot.physics.sole_truth().feet
    robot.run(1.0)
    assert np.allclose(robot.physics.sole_truth().feet, feet, atol=0.02)  # it waits for a new goal
    x, y, yaw = (float(part) for part in robot.physics.sole_truth().centre)
    status, _ = robot.result(robot.send(walk(x + 0.2 * np.cos(yaw), y + 0.2 * np.sin(yaw), yaw)))
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert not robot.fell


def everybody_commands(robot: Robot) -> None:
    """Send every other command for a second: no foot and no arm moves."""
    robot.run(1.0)
    feet, joints = robot.physics.sole_truth().feet, robot.setpoints[-1]
    steer = robot.publisher(Twist, "/humanoid/cmd_vel", 1)
    plan = robot.publisher(FootstepPlan, "/footsteps/plan", 1)
    upcoming = robot.publisher(FootstepPlan, "/footsteps/upcoming", LATCHED)
    posture = robot.publisher(JointState, "/posture", 1)
    say = robot.publisher(String, "/speech/text", 10)
    step = Footstep(robot.gait.footstep_index, Leg.LEFT, feet[0][0] + 0.1, feet[0][1], feet[0][2])
    raised = standing_posture()
    raised[9] += 0.5
    for number in range(20):
        steer(Twist(linear=Vector3(x=0.2)))
        steps = messages.footstep_plan(Plan(1000 + number, (step,), (0.0, 0.0, 0.0)), robot.physics.stamp)
        plan(steps)
        upcoming(steps)
        posture(messages.posture(Posture(raised), robot.physics.stamp))
        say(String(data="walk home"))
        robot.run(0.05)
    assert np.allclose(robot.physics.sole_truth().feet, feet, atol=0.02)
    assert np.abs(robot.setpoints[-1] - joints).max() < 0.15
    robot.expect("whole_body_controller", f"emergency stop: {PRESSED}")
    robot.expect("high_level_task_manager", "'walk 0.0 0.0 0.0' is not done: emergency stop")


@pytest.mark.parametrize(
    "late",
    [
        "whole_body_controller",
        pytest.param("navigation_action_server", marks=pytest.mark.slow),
        "emergency_stop",
    ],
)
def test_who_starts_after_it_was_pressed_obeys(make_robot: MakeRobot, late: str) -> None:
    robot = make_robot(*EVERYBODY, high_level_task_manager={"tasks": ["wait 60"]})
    robot.until(lambda: robot.mode is Mode.STANDING)
    press(robot, down=True)
    robot.until(lambda: robot.mode is Mode.EMERGENCY_STOP)
    for name in {late, "dance_action_server", "high_level_task_manager"} - {"whole_body_controller"}:
        robot.kill(name)
    if late == "whole_body_controller":
        robot.kill(late)
        robot.run(0.3)
        robot.start(late)
        robot.until(lambda: not robot.standby)
    else:
        robot.run(0.3)
        robot.start(late)
    robot.start("dance_action_server")
    robot.start("high_level_task_manager")
    robot.run(0.1)
    assert not robot.send(walk(0.3)).accepted
    assert not robot.send(PerformDance.Goal(dance="wave")).accepted
    robot.expect("navigation_action_server", "goal rejected: emergency stop: ")
    robot.expect("dance_action_server", "goal rejected: emergency stop: ")
    robot.run(1.5)  # the task manager looks for tasks ten times a second
    assert robot.mode is Mode.EMERGENCY_STOP
    assert "the button was pressed" in robot.gait.reason
    assert robot.task().state == TaskStatus.STATE_IDLE
    assert press(robot, down=False).success
    robot.until(lambda: robot.mode is Mode.STANDING)


def test_it_is_lifted_only_when_nobody_asks_for_it(make_robot: MakeRobot) -> None:
    robot = make_robot(*EVERYBODY)
    robot.until(lambda: robot.mode is Mode.STANDING)
    heard: list[EmergencyStop] = []
    robot.listen(EmergencyStop, "/emergency_stop", heard.append, LATCHED)
    dance = robot.send(PerformDance.Goal(dance="wave"))
    robot.run(1.0)
    battery = robot.publisher(BatteryStatus, "/battery", LATCHED)
    battery(BatteryStatus(level=BatteryStatus.LEVEL_CRITICAL, charge=0.03))
    status, result = robot.result(dance)
    assert (status, result.completed) == (GoalStatus.STATUS_ABORTED, False)
    assert result.message == "emergency stop: battery: the battery is at 3%"
    assert (heard[-1].active, heard[-1].cause) == (True, EmergencyStop.CAUSE_BATTERY)
    press(robot, down=True)
    answer = press(robot, down=False)
    assert (answer.success, answer.message) == (
        False,
        "battery still requests the stop: the battery is at 3%",
    )
    robot.run(0.5)
    assert robot.mode is Mode.EMERGENCY_STOP
    battery(BatteryStatus(level=BatteryStatus.LEVEL_NORMAL, charge=0.9))
    robot.run(0.5)
    assert robot.mode is Mode.EMERGENCY_STOP  # charging alone does not lift the stop
    assert press(robot, down=False).success
    robot.until(lambda: robot.mode is Mode.STANDING)
    assert not heard[-1].active
    robot.physics.push(np.array([0.0, 900.0, 0.0]), 0.2)
    robot.until(lambda: heard[-1].active)
    assert heard[-1].cause == EmergencyStop.CAUSE_FALL
    answer = press(robot, down=False)
    assert (answer.success, answer.message) == (False, "fall still requests the stop: the robot has fallen")

"""Footsteps, navigation, dances, tasks: decisions without physics, and some with it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from humanoid.data import SECOND, STOP_CALLED, GaitState, JointStates, Leg, Mode, Stance, Support
from humanoid.planning import dance
from humanoid.planning.choreography import DANCES
from humanoid.planning.events import Event, event_of
from humanoid.planning.following import steps_to_last_line
from humanoid.planning.footsteps import (
    PlanStatus,
    StepLimits,
    beside,
    plan_footsteps,
    shorter,
)
from humanoid.planning.gait import GaitPlanner
from humanoid.planning.navigation import Navigation
from humanoid.planning.task_manager import TaskManager
from humanoid.planning.tasks import Task, task_of, words_of
from humanoid.planning.teleop import Teleop, VelocityLimits
from humanoid.planning.walks import GoalTolerance, Outcome
from humanoid.robot.body import OURS
from humanoid.robot.ground import Ground, Obstacle
from humanoid.robot.model import HumanoidModel
from humanoid.robot.table import JOINT_NAMES, UPPER_BODY
from humanoid.simulation.battery import BatteryMonitor, BatteryPack, BatteryReading, Level
from humanoid.simulation.sim import Noise
from humanoid.spatial import to_frame, wrap
from humanoid.trials.harness import Lockstep
from humanoid.trials.trials import navigate
from hypothesis import given, settings
from hypothesis import strategies as st

HERE = Stance(Support.BOTH, (np.array([0.0, 0.09, 0.0]), np.array([0.0, -0.09, 0.0])))
LIMITS = StepLimits()


@settings(max_examples=150)
@given(
    x=st.floats(-8, 8),
    y=st.floats(-8, 8),
    yaw=st.floats(-math.pi, math.pi),
    start=st.floats(-math.pi, math.pi),
    first=st.sampled_from([None, Leg.LEFT, Leg.RIGHT]),
)
def test_plans_lead_to_the_goal_in_steps_that_legs_can_take(
    x: float, y: float, yaw: float, start: float, first: Leg | None
) -> None:
    base = np.array([0.3, -0.2, start])
    stance = Stance(Support.BOTH, (beside(base, Leg.LEFT), beside(base, Leg.RIGHT)))
    result = plan_footsteps(stance, (x, y, yaw), first_leg=first, first_index=7)
    if result.status is PlanStatus.ALREADY_THERE:
        return
    assert result.status is PlanStatus.PLANNED, result.message
    steps = result.plan.steps
    assert [step.index for step in steps] == list(range(7, 7 + len(steps)))
    assert first is None or steps[0].leg is first
    feet = list(stance.feet)
    for step, after in zip(steps, (*steps[1:], None), strict=True):
        assert after is None or after.leg is step.leg.other
        ahead, aside = to_frame(feet[step.leg.other.side], step.pose[:2])
        assert 0.10 < step.leg.sign * aside < 0.32
        assert abs(ahead) < LIMITS.forward + 0.06
        assert abs(wrap(step.yaw - feet[step.leg.other.side][2])) < 0.4
        feet[step.leg.side] = step.pose
    centre = Stance(Support.BOTH, (feet[0], feet[1])).centre
    assert math.hypot(centre[0] - x, centre[1] - y) < 3e-3
    assert abs(wrap(centre[2] - yaw)) < 3e-3
    assert np.allclose(to_frame(feet[1], feet[0][:2]), (0.0, 0.18), atol=1e-3)


@pytest.mark.parametrize("ahead", [Leg.LEFT, Leg.RIGHT])
def test_a_walk_that_was_broken_off_goes_on_with_the_foot_behind(ahead: Leg) -> None:
    feet = [foot.copy() for foot in HERE.feet]
    feet[ahead.side][0] = 0.33
    stance = Stance(Support.BOTH, (feet[0], feet[1]))
    route = [(0.165, 0.0), (1.0, 0.02 * ahead.sign), (2.0, 0.0), (3.0, 0.0)]
    planner = GaitPlanner(LIMITS)
    planner.velocity(0.5, 0.0, 0.1 * ahead.sign)  # the leg on this side would rather begin
    steered = planner.update(GaitState(SECOND, Mode.STANDING, "", stance, 0, 4, 0.0))
    assert steered is not None
    for steps in (
        plan_footsteps(stance, (2.0, 0.0, 0.0)).plan.steps,
        steps_to_last_line(stance, route, LIMITS, None, 4)[0],
        steered.steps,
    ):
        assert steps[0].leg is ahead.other
        assert abs(steps[0].x - 0.33) < LIMITS.forward


def _answer(goal: tuple[float, float, float], ground: Ground | None = None, stance: Stance = HERE) -> str:
    result = plan_footsteps(stance, goal, ground=ground)
    assert not result.plan.steps
    return f"{result.status.name}: {result.message}"


def test_goals_that_cannot_be_reached_are_rejected_with_the_reason() -> None:
    chair = Ground(obstacles=(Obstacle("the chair", 1.0, 0.0, 0.2),))
    assert _answer((1.0, 0.1, 0.0), chair) == "BLOCKED: the goal (1.00, 0.10) is occupied by the chair"
    assert _answer((2.0, 0.0, 0.0), chair).startswith("BLOCKED: step 2 of 7: (0.7")
    assert _answer((60.0, 0.0, 0.0)) == "BLOCKED: the goal (60.00, 0.00) is off the floor, which ends at 50 m"
    far = Ground(half_size=1000.0)
    assert _answer((200.0, 0.0, 0.0), far).startswith(
        "TOO_FAR: the goal is 200.0 m away: more than the 512 steps"
    )
    assert _answer((math.nan, 0.0, 0.0)).startswith("INVALID_REQUEST: the goal holds a number")
    broken = Stance(Support.BOTH, (np.array([0.0, math.inf, 0.0]), HERE.feet[1]))
    assert _answer((1.0, 0.0, 0.0), stance=broken).startswith("INVALID_REQUEST: the stance")
    apart = Stance(Support.BOTH, (np.array([0.0, 2.0, 0.0]), HERE.feet[1]))
    assert "2.09 m apart" in _answer((1.0, 0.0, 0.0), stance=apart)
    assert _answer((0.0, 0.0, 0.0)).startswith("ALREADY_THERE")
    slow = plan_footsteps(HERE, (1.0, 0.0, 0.0), limits=replace(LIMITS, step_time=9.0))
    assert slow.status is PlanStatus.INVALID_REQUEST


def test_shorter_steps_are_more() -> None:
    few = plan_footsteps(HERE, (2.0, 0.0, 0.0)).plan.steps
    many = plan_footsteps(HERE, (2.0, 0.0, 0.0), limits=shorter(LIMITS, 0.1)).plan.steps
    assert len(many) > 1.5 * len(few)
    assert shorter(LIMITS, 0.0) == LIMITS
    assert shorter(LIMITS, 5.0) == LIMITS


def _gait(mode: Mode = Mode.STANDING, reason: str = "", stamp: int = 0) -> GaitState:
    return GaitState(stamp, mode, reason, HERE, 0, 0, 0.0)


def test_navigation_rejects_what_it_cannot_do() -> None:
    assert "off the floor" in Navigation((99.0, 0.0, 0.0), _gait()).rejection
    assert "tolerances" in Navigation((1.0, 0.0, 0.0), _gait(), tolerance=GoalTolerance(math.nan)).rejection
    assert "red button" in Navigation((1.0, 0.0, 0.0), _gait(Mode.EMERGENCY_STOP, "red button")).rejection
    assert Navigation((1.0, 0.0, 0.0), _gait()).rejection == ""


@pytest.mark.parametrize(
    ("mode", "outcome"),
    [
        (Mode.FALLEN, Outcome.FELL),
        (Mode.HOLDING, Outcome.STOPPED),
        (Mode.EMERGENCY_STOP, Outcome.STOPPED),
    ],
)
def test_navigation_ends_with_the_robot(mode: Mode, outcome: Outcome) -> None:
    navigation = Navigation((1.0, 0.0, 0.0), _gait())
    assert navigation.update(_gait()).plan is not None
    result = navigation.update(_gait(mode, "why", 2 * SECOND)).result
    assert result is not None
    assert (result.outcome, result.time) == (outcome, 2.0)


def test_navigation_goes_on_after_the_robot_has_held() -> None:
    navigation = Navigation((1.0, 0.0, 0.0), _gait(), recovery_time=5.0)
    assert navigation.update(_gait()).plan is not None
    tick = navigation.update(_gait(Mode.HOLDING, "no odometry", 2 * SECOND))
    assert (tick.stop, tick.plan, tick.result, tick.feedback.replanning) == (True, None, None, True)
    tick = navigation.update(_gait(stamp=3 * SECOND))
    assert tick.plan is not None
    assert (tick.stop, tick.result) == (False, None)
    # It is asked for the second time, and for too long.
    assert navigation.update(_gait(Mode.HOLDING, "no odometry", 4 * SECOND)).result is None
    assert navigation.update(_gait(Mode.HOLDING, "no odometry", 8 * SECOND)).result is None
    result = navigation.update(_gait(Mode.HOLDING, "no odometry", 9 * SECOND)).result
    assert result is not None
    assert (result.outcome, result.message) == (Outcome.STOPPED, "no odometry")


def test_navigation_does_not_wait_where_the_robot_was_asked_to_stop() -> None:
    navigation = Navigation((1.0, 0.0, 0.0), _gait(), recovery_time=5.0)
    result = navigation.update(_gait(Mode.HOLDING, STOP_CALLED)).result
    assert result is not None
    assert result.outcome is Outcome.STOPPED


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"stamp": 0}, "the simulation has started again"),
        ({"plan_id": 0}, "whole_body_controller has restarted"),
        (
            {"plan_id": 1, "mode": Mode.WALKING},
            "the robot walks a plan that counts its steps anew, 1 after 5: ",
        ),
        (
            {"plan_id": 0, "mode": Mode.WALKING},
            "the robot walks a plan that counts its steps anew, 1 after 5: ",
        ),
    ],
)
def test_navigation_says_why_steps_are_counted_anew(changes: dict[str, Any], reason: str) -> None:
    before = replace(_gait(stamp=SECOND), footstep_index=5, plan_id=3)
    walk = Navigation((1.0, 0.0, 0.0), before)
    values = {"stamp": 2 * SECOND, "footstep_index": 1} | changes
    result = walk.update(replace(before, **values)).result
    assert result is not None
    assert result.outcome is Outcome.STOPPED
    assert result.message.startswith(reason)


def test_navigation_is_canceled_while_the_robot_holds() -> None:
    navigation = Navigation((1.0, 0.0, 0.0), _gait(), recovery_time=5.0)
    assert navigation.update(_gait(Mode.HOLDING, "no odometry")).result is None
    navigation.cancel()
    result = navigation.update(_gait(Mode.HOLDING, "no odometry")).result
    assert result is not None
    assert result.outcome is Outcome.CANCELED


def test_navigation_already_there_is_reached_at_once() -> None:
    navigation = Navigation((0.0, 0.0, 0.0), _gait())
    result = navigation.update(_gait()).result
    assert result is not None
    assert (result.outcome, result.steps) == (Outcome.REACHED, 0)


def test_navigation_walks_and_reports(model: HumanoidModel) -> None:
    robot = Lockstep(model, seed=5, noise=Noise())
    robot.run(0.5)
    result = navigate(robot, (0.6, -0.2, -0.5))
    assert result is not None
    assert result.outcome is Outcome.REACHED
    assert 4 <= result.steps <= 10
    assert robot.distance_to((0.6, -0.2, -0.5)) < 0.06


def _dance(
    model: HumanoidModel, name: str, cancel_at: float = math.inf
) -> tuple[Lockstep, dance.DanceResult, list[float]]:
    robot = Lockstep(model, seed=6, noise=Noise())
    robot.run(0.5)
    under_way = dance.Dance(name, 0.0, 0, robot.simulator.stamp)
    began, progress = robot.time, []
    while robot.time - began < 40.0:
        robot.tick()
        assert robot.gait is not None
        if robot.time - began > cancel_at:
            under_way.cancel()
        joints = robot.simulator.sensors().joints
        tick = under_way.update(robot.simulator.stamp, joints, robot.gait)
        robot.controller.posture(tick.posture)
        progress.append(tick.feedback.progress)
        if tick.plan is not None:
            robot.planner.walk(tick.plan)
        if tick.result is not None:
            robot.run(1.0)
            return robot, tick.result, progress
    raise AssertionError("the dance does not end")


@pytest.mark.parametrize(
    "name", ["wave", *(pytest.param(name, marks=pytest.mark.slow) for name in ("disco", "waltz"))]
)
def test_dances_from_standing_to_standing(model: HumanoidModel, name: str) -> None:
    robot, result, progress = _dance(model, name)
    assert not robot.fell
    assert result.completed, result.message
    assert result.beats == len(DANCES[name].beats)
    assert progress == sorted(progress)
    assert progress[-1] == 1.0
    assert result.joint_error < 0.15
    assert robot.controller.mode is Mode.STANDING
    assert robot.refused == ""
    assert (result.steps > 10) == (name == "waltz")


def test_a_cancelled_dance_goes_back_to_standing(model: HumanoidModel) -> None:
    robot, result, _ = _dance(model, "disco", cancel_at=3.0)
    assert not result.completed
    assert result.message == "canceled"
    assert robot.controller.mode is Mode.STANDING
    assert not robot.fell


def test_dances_are_within_the_joints_limits(model: HumanoidModel) -> None:
    for choreography in DANCES.values():
        for beat in choreography.beats:
            assert (beat.joints(OURS) >= model.lower[UPPER_BODY]).all()
            assert (beat.joints(OURS) <= model.upper[UPPER_BODY]).all()
            assert set(beat.pose) <= set(JOINT_NAMES[UPPER_BODY])


def test_dances_that_cannot_be_danced() -> None:
    assert dance.problem("tango", 0.0) == "there is no dance 'tango'; I know disco, waltz, wave"
    assert "500 beats" in dance.problem("wave", 500.0)
    assert "nan beats" in dance.problem("wave", math.nan)
    assert dance.problem("wave", 0.0) == dance.problem("disco", 120.0) == ""


def test_a_dance_ends_with_an_emergency_stop() -> None:
    under_way = dance.Dance("wave", 0.0, 0, 0)
    joints = JointStates(0, np.zeros(29), np.zeros(29), np.zeros(29))
    assert under_way.update(0, joints, _gait()).result is None
    result = under_way.update(SECOND, joints, _gait(Mode.EMERGENCY_STOP, "/teleop: red button")).result
    assert result is not None
    assert (result.completed, result.message) == (False, "emergency stop: /teleop: red button")


def test_teleop_limits_and_smooths() -> None:
    teleop = Teleop(VelocityLimits(forward=0.2, acceleration=0.5))
    assert teleop.update(0) == (0.0, 0.0, 0.0)
    assert teleop.command(9.0, 0.0, -9.0, 0)
    assert not teleop.command(math.nan, 0.0, 0.0, 0)
    assert teleop.refused == 1
    assert teleop.update(SECOND // 10) == pytest.approx((0.05, 0.0, -0.08))
    for tenth in range(2, 6):
        velocity = teleop.update(tenth * SECOND // 10)
    assert velocity == pytest.approx((0.2, 0.0, -0.25))
    assert teleop.update(11 * SECOND // 10)[0] < 0.2  # nobody has sent anything for more than half a second
    assert teleop.update(3 * SECOND) == (0.0, 0.0, 0.0)


def test_battery_levels_with_a_margin() -> None:
    monitor = BatteryMonitor()
    assert monitor.verdict(0).level is Level.UNKNOWN

    def level(stamp: int, charge: float, temperature: float = 25.0) -> Level:
        monitor.take(BatteryReading(stamp * SECOND, 48.0, -2.0, charge, temperature))
        return monitor.verdict(stamp * SECOND).level

    assert [level(i, charge) for i, charge in enumerate((0.9, 0.24, 0.26, 0.29, 0.09, 0.12, 0.2))] == [
        Level.NORMAL,
        Level.LOW,
        Level.LOW,
        Level.NORMAL,
        Level.CRITICAL,
        Level.CRITICAL,
        Level.LOW,
    ]
    assert level(8, 0.9, temperature=70.0) is Level.LOW
    monitor.take(BatteryReading(9 * SECOND, math.nan, 0.0, math.nan, 0.0))
    assert monitor.verdict(30 * SECOND).level is Level.UNKNOWN


def test_walking_empties_the_battery() -> None:
    pack = BatteryPack(charge=0.5, capacity=100.0)
    monitor = BatteryMonitor()
    still = np.zeros(29)
    for second in range(60):
        monitor.take(pack.update(JointStates(second * SECOND, still, still, still)))
    idle = monitor.verdict(59 * SECOND)
    assert idle.time_left == pytest.approx(0.5 * 100 * 3600 / 60, rel=0.1)  # 60 W of a pack of 100 Wh
    for second in range(60, 120):
        monitor.take(pack.update(JointStates(second * SECOND, still, np.ones(29), np.full(29, 10.0))))
    busy = monitor.verdict(119 * SECOND)
    assert busy.time_left < 0.3 * idle.time_left
    assert busy.reading is not None
    assert busy.reading.current < -5.0
    assert not busy.charging


def test_tasks_one_after_the_other() -> None:
    walk, dancing = Task("walk", place=(1.0, 0.0, 0.0)), Task("dance", name="wave", tries=1)
    manager = TaskManager([walk, dancing])
    assert manager.update().start is walk
    assert manager.update().start is None
    manager.finished(False, "missed")
    assert manager.update().start is walk  # a second attempt
    manager.finished(True, "")
    assert manager.update().start is dancing
    manager.finished(False, "no")
    assert manager.update().start is None
    assert manager.idle
    assert [(task.kind, success) for task, success, _ in manager.done] == [("walk", True), ("dance", False)]


def test_tasks_end_with_the_battery_or_a_stop() -> None:
    walk, wait = Task("walk"), Task("wait", seconds=1.0)
    manager = TaskManager([walk, wait])
    manager.update()
    assert not manager.update(Level.LOW).cancel  # the present task may end
    manager.finished(True, "")
    assert manager.update().start is None
    assert manager.ended == "battery low"
    urgent = TaskManager([walk, wait])
    urgent.update()
    assert urgent.update(stopped=True).cancel
    assert not urgent.update(stopped=True).cancel  # once is enough
    urgent.finished(False, "canceled")
    assert urgent.idle
    assert urgent.done[0][2] == "canceled"


@pytest.mark.parametrize(
    ("words", "task"),
    [
        ("walk 1.0 0.5 1.57", Task("walk", place=(1.0, 0.5, 1.57))),
        ("walk 0 0 -0.1 for 4", Task("walk", place=(0.0, 0.0, -0.1), seconds=4.0)),
        ("dance wave", Task("dance", name="wave")),
        ("dance waltz 12", Task("dance", name="waltz", beats=12)),
        ("look 2 0.1 1.4", Task("look", place=(2.0, 0.1, 1.4), seconds=3.0)),
        ("point 2 0.1 1.4 for 0.7", Task("point", place=(2.0, 0.1, 1.4), seconds=0.7)),
        ("wait 0.3", Task("wait", seconds=0.3)),
    ],
)
def test_tasks_in_words(words: str, task: Task) -> None:
    assert task_of(words) == task
    assert task_of(words_of(task)) == task


@pytest.mark.parametrize(
    "words",
    ["", "fly", "walk", "walk 1 2", "walk 1 2 nan", "walk 1 2 3 until 4", "walk 1 2 3 for -1", "dance", "dance wave x",
     "dance wave -1", "dance wave 1 2", "wait", "wait inf", "look 1 2 x", "point 1 2 3 4"],
)  # fmt: skip
def test_what_is_no_task_is_said(words: str) -> None:
    with pytest.raises(ValueError, match="is not a task: say `walk X Y YAW`"):
        task_of(words)


@pytest.mark.parametrize(
    ("text", "event"),
    [
        ("12.5: press", Event("press", delay=12.5)),
        ("task 2 + 3.1: push 4 180", Event("push", task=2, delay=3.1, numbers=(4.0, 180.0))),
        ("after task 1: say walk 0.6 0.3 0", Event("say", task=1, after=True, words="walk 0.6 0.3 0")),
        ("task 3: joystick 0.5 0 -1 for 2", Event("joystick", task=3, numbers=(0.5, 0.0, -1.0, 2.0))),
        ("0: move box 1.0 -0.2", Event("move", words="box", numbers=(1.0, -0.2))),
        ("after task 2+1:release", Event("release", task=2, after=True, delay=1.0)),
    ],
)
def test_events_in_words(text: str, event: Event) -> None:
    assert event_of(text) == event


@pytest.mark.parametrize(
    "text",
    ["", "press", "now: press", "12: push 4", "12: push 4 x", "task: press", "task 1 + x: press", "nan: press",
     "1: say", "1: joystick 1 0 0", "1: move box 1", "1: dance", "before task 1: press"],
)  # fmt: skip
def test_what_is_no_event_is_said(text: str) -> None:
    with pytest.raises(ValueError, match="is not an event: write WHEN: WHAT, such as"):
        event_of(text)

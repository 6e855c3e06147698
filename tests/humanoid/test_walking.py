"""Walking, in a loop of simulator, estimator, gait planner and controller: only physics moves the robot.

Thresholds have slack; benchmarks/humanoid.py prints the exact figures.
"""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from humanoid.control.pace import Pace
from humanoid.control.reference import GaitParameters, straight_steps
from humanoid.control.stepping import Stepping
from humanoid.data import Footstep, FootstepPlan, Leg, Mode, Support
from humanoid.kinematics.dynamics import natural_frequency
from humanoid.planning.footsteps import plan_footsteps
from humanoid.robot.model import HumanoidModel
from humanoid.robot.table import ARMS
from humanoid.simulation.sim import QUIET, Noise
from humanoid.spatial import to_frame, wrap
from humanoid.trials.harness import Lockstep
from humanoid.trials.trials import STRAIGHT, push, random_goals

NOISE = Noise()


def _walked(model: HumanoidModel, *, true_state: bool, noise: Noise, seed: int = 0) -> Lockstep:
    robot = Lockstep(model, seed=seed, noise=noise, true_state=true_state)
    robot.run(0.5)
    assert robot.controller.follow(STRAIGHT) == ""
    robot.settle(20.0)
    assert not robot.fell
    assert len(robot.touchdowns) == 12
    assert robot.controller.mode is Mode.STANDING
    return robot


@pytest.mark.parametrize("seconds", [5.0, pytest.param(60.0, marks=pytest.mark.slow)])
def test_stands(model: HumanoidModel, seconds: float) -> None:
    robot = Lockstep(model, seed=1, noise=NOISE)
    robot.run(4.0)  # its soles find out how level the IMU is
    before = robot.simulator.truth().position
    feet = robot.simulator.sole_truth().feet
    robot.run(seconds)
    assert not robot.fell
    assert np.linalg.norm(robot.simulator.truth().position - before) < 3e-3
    moved = [np.abs(a - b).max() for a, b in zip(feet, robot.simulator.sole_truth().feet, strict=True)]
    assert max(moved) < 2e-3
    assert robot.controller.mode is Mode.STANDING


@pytest.mark.slow
def test_walks_by_the_true_state(model: HumanoidModel) -> None:
    robot = _walked(model, true_state=True, noise=QUIET)
    rms, _ = robot.foot_error()
    assert rms < 0.010
    assert max(touchdown.yaw_error for touchdown in robot.touchdowns) < math.radians(2)
    assert robot.distance_to(STRAIGHT.goal) < 0.02


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))])
def test_walks_by_sensors_alone(model: HumanoidModel, seed: int) -> None:
    robot = _walked(model, true_state=False, noise=NOISE, seed=seed)
    rms, _ = robot.foot_error()
    assert rms < 0.040


@pytest.mark.parametrize(
    "speed", [0.6, *(pytest.param(each, marks=pytest.mark.slow) for each in (0.1, 0.35))]
)
def test_walks_at_every_speed(model: HumanoidModel, speed: float) -> None:
    pace = Pace(speed)
    robot = Lockstep(model, seed=1, noise=NOISE, parameters=GaitParameters().at_pace(pace))
    robot.run(0.5)
    steps = straight_steps(8, pace.step_length, 0.18, pace.step_time)
    assert robot.controller.follow(FootstepPlan(1, steps, (0.0, 0.0, 0.0))) == ""
    robot.run(1.3)  # the weight moves to the left foot
    moments = []
    while not robot.fell and not robot.controller.stepping.standing:
        robot.tick()
        data, arms = robot.simulator.data, model.qpos[[arm.start for arm in ARMS]]
        feet = robot.simulator.sole_truth().feet
        moments.append((feet[0][0] - feet[1][0], data.qpos[arms[0]] - data.qpos[arms[1]]))
    assert not robot.fell
    assert robot.foot_error()[0] < 0.030
    times = [touchdown.stamp * 1e-9 for touchdown in robot.touchdowns]
    assert 6 * pace.step_length / (times[6] - times[0]) == pytest.approx(speed, rel=0.02)
    # A positive angle is an arm that swings back: it does with the foot of its side in front.
    assert np.corrcoef(np.array(moments).T)[0, 1] > 0.8


@pytest.mark.parametrize("speed", [0.0, 0.61, math.nan])
def test_no_legs_walk_at_other_speeds(speed: float) -> None:
    with pytest.raises(ValueError, match=r"0\.1 to 0\.6 m/s"):
        Pace(speed)


def test_walks_to_a_goal(model: HumanoidModel) -> None:
    goal = (1.0, 0.5, math.pi / 2)
    robot = Lockstep(model, true_state=True)
    assert robot.go_to(goal) < 0.020
    assert abs(wrap(robot.simulator.sole_truth().centre[2] - goal[2])) < math.radians(3)
    assert not robot.fell


@pytest.mark.parametrize(
    "goal",
    [
        (-0.4, 0.1, 0.0),
        pytest.param((0.0, 0.3, 0.0), marks=pytest.mark.slow),
        pytest.param((-1.0, 0.0, math.pi), marks=pytest.mark.slow),
    ],
)
def test_walks_backwards_sideways_and_turns(model: HumanoidModel, goal: tuple[float, float, float]) -> None:
    robot = Lockstep(model, seed=3, noise=NOISE)
    assert robot.go_to(goal) < 0.06
    assert not robot.fell


@pytest.mark.slow
def test_cancel_joins_the_feet(model: HumanoidModel) -> None:
    random = np.random.default_rng(0)
    for seed in range(6):
        robot = Lockstep(model, seed=seed, noise=NOISE)
        robot.run(0.5)
        robot.planner.walk(plan_footsteps(robot.controller.state().stance, (2.0, 0.6, 1.0)).plan)
        robot.run(random.uniform(0.2, 8.0))
        began = robot.time
        robot.planner.cancel()
        robot.settle(10.0)
        assert not robot.fell
        assert robot.time - began <= 2.5
        left, right = robot.simulator.sole_truth().feet
        assert np.allclose(to_frame(right, left[:2]), (0.0, 0.18), atol=0.03)
        assert abs(wrap(left[2] - right[2])) < 0.08


@pytest.mark.parametrize(
    ("direction", "momentum"),
    [(90, 4)]
    + [pytest.param(angle, 4, marks=pytest.mark.slow) for angle in (0, 180, 270)]
    + [pytest.param(angle, 16, marks=pytest.mark.slow) for angle in range(0, 360, 30)]
    + [pytest.param(angle, 20, marks=pytest.mark.slow) for angle in range(0, 360, 45)],
)
def test_pushed_while_standing(model: HumanoidModel, direction: int, momentum: float) -> None:
    robot = Lockstep(model, seed=direction, noise=NOISE)
    robot.run(0.5)
    push(robot, direction, momentum)
    robot.run(4.0)
    assert not robot.fell
    assert np.linalg.norm(robot.controller.error) < (0.01 if momentum < 20 else 0.02)


def _pushed(
    model: HumanoidModel, steps: Sequence[Footstep], when: float, direction: float, momentum: float = 6.0
) -> Lockstep:
    """Walk these steps with a push of the given impulse [N s] at the given time [s]."""
    robot = Lockstep(model, seed=1, noise=NOISE)
    robot.run(0.5)
    assert robot.controller.follow(FootstepPlan(1, tuple(steps), (0.0, 0.0, 0.0))) == ""
    robot.run(when)
    push(robot, direction, momentum)
    robot.settle(20.0)
    return robot


@pytest.mark.parametrize(
    ("when", "direction", "momentum"),
    [(2.7, 110, 6)]
    + [
        pytest.param(*each, 6, marks=pytest.mark.slow)
        for each in [(2.55, 90), (2.9, 270), (3.3, 0), (3.4, 290)]
    ]
    + [
        pytest.param(2.6 + 0.175 * phase, 45 * eighth, 6, marks=pytest.mark.slow)
        for phase in range(8)
        for eighth in range(8)
    ],
)
def test_pushed_while_walking(model: HumanoidModel, when: float, direction: int, momentum: float) -> None:
    """At 2.6 s the right foot leaves the ground, at 3.3 s the left one."""
    robot = _pushed(model, STRAIGHT.steps, when, direction, momentum)
    assert not robot.fell
    assert len(robot.touchdowns) >= 12


@pytest.mark.slow
@pytest.mark.parametrize(
    ("goal", "when"), [((0.0, 0.0, 3.0), 2.9), ((0.0, 0.4, 0.0), 3.7), ((-0.44, 0.0, 0.0), 2.9)]
)
@pytest.mark.parametrize("direction", [0, 90, 270])
def test_pushed_in_other_steps(
    model: HumanoidModel, goal: tuple[float, float, float], when: float, direction: int
) -> None:
    """Turning in place, sidesteps, steps back."""
    stance = Lockstep(model).controller.state().stance
    assert not _pushed(model, plan_footsteps(stance, goal).plan.steps, when, direction).fell


@pytest.mark.parametrize("direction", [0, 180])
def test_steps_when_its_soles_cannot_hold_it(model: HumanoidModel, direction: int) -> None:
    robot = Lockstep(model, seed=direction, noise=NOISE)
    robot.run(0.5)
    push(robot, direction, 20.0)
    robot.run(4.0)
    assert not robot.fell
    assert len(robot.touchdowns) == 2
    assert np.linalg.norm(robot.controller.error) < 0.02  # the feet end up wide apart


def test_pushed_over_the_foot_that_stays_in_the_last_step(model: HumanoidModel) -> None:
    last = replace(STRAIGHT.steps[3], x=STRAIGHT.steps[2].x)
    robot = _pushed(model, (*STRAIGHT.steps[:3], last), 3.35, 270)
    assert not robot.fell
    left, right = robot.simulator.sole_truth().feet
    assert np.allclose(to_frame(right, left[:2]), (0.0, 0.18), atol=0.10)


def test_a_new_plan_does_not_undo_the_hurry(model: HumanoidModel) -> None:
    stepping = Stepping(GaitParameters(), natural_frequency(GaitParameters().com_height), 0.004, model.sole)
    assert stepping.follow(STRAIGHT) == ""
    sample = stepping.next()
    while sample.phase < 0.2:
        sample = stepping.next()
    stepping.adjust(np.array([0.0, 0.08]))  # over the left foot, while the right one swings
    assert stepping.follow(STRAIGHT) == ""
    assert stepping.next().time_left < 0.6 * sample.time_left


@pytest.mark.parametrize(
    "delay",
    [
        (3,),
        tuple(range(6)),
        pytest.param((1,), marks=pytest.mark.slow),
        pytest.param((2,), marks=pytest.mark.slow),
    ],
)
def test_walks_though_commands_come_late(model: HumanoidModel, delay: tuple[int, ...]) -> None:
    """Commands are late by these numbers of ticks of 4 ms, or by any of them."""
    robot = Lockstep(model, seed=1, noise=NOISE, delay=delay)
    assert robot.go_to((1.0, 0.3, 0.5)) < 0.15
    assert not robot.fell


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_random_goals_with_noise_and_pushes(model: HumanoidModel) -> None:
    trial = random_goals(model, goals=20, momentum=3.0, seed=5)
    assert trial.falls == 0
    assert trial.reached == 20


@pytest.mark.slow
def test_a_push_to_the_outside_hurries_the_swing(model: HumanoidModel) -> None:
    """No step can catch a robot that falls over its stance foot; the other foot must come down sooner."""

    def swing_time(momentum: float) -> int:
        robot = Lockstep(model, seed=1, noise=NOISE)
        robot.run(0.5)
        robot.controller.follow(STRAIGHT)
        robot.run(1.2 + 1.4 + 0.1)  # the right leg swings
        push(robot, 90.0, momentum)
        began = robot.simulator.stamp
        while len(robot.touchdowns) < 3 and not robot.fell:
            robot.tick()
        robot.settle(20.0)
        assert not robot.fell
        return robot.touchdowns[2].stamp - began

    assert swing_time(6.0) < swing_time(0.0) - 40_000_000


@pytest.mark.slow
def test_a_new_plan_takes_over_in_the_middle(model: HumanoidModel) -> None:
    robot = Lockstep(model, seed=2, noise=NOISE)
    robot.run(0.5)
    robot.planner.walk(plan_footsteps(robot.controller.state().stance, (2.0, 0.0, 0.0)).plan)
    robot.run(4.1)
    assert robot.gait is not None
    moving = {Support.LEFT: Leg.RIGHT, Support.RIGHT: Leg.LEFT}[robot.gait.stance.support]
    step = next(s for s in robot.planner.plan.steps if s.index == robot.gait.footstep_index)
    feet = list(robot.gait.stance.feet)
    feet[moving.side] = step.pose
    stance = type(robot.gait.stance)(Support.BOTH, (feet[0], feet[1]))
    goal = (0.8, 0.8, 1.5)
    plan = plan_footsteps(stance, goal, first_leg=moving.other, first_index=step.index + 1).plan
    robot.planner.walk(FootstepPlan(0, (step, *plan.steps), goal))
    robot.settle(30.0)
    assert robot.refused == ""
    assert not robot.fell
    assert robot.distance_to(goal) < 0.06


def test_steered_by_velocity(model: HumanoidModel) -> None:
    robot = Lockstep(model, seed=4, noise=NOISE)
    robot.run(0.5)
    robot.planner.velocity(0.2, 0.0, 0.1)
    robot.run(8.0)
    robot.planner.velocity(0.0, 0.0, 0.0)
    robot.settle(5.0)
    assert not robot.fell
    assert robot.refused == ""
    x, _, yaw = robot.simulator.sole_truth().centre
    assert x > 0.8
    assert yaw > 0.5
    assert robot.controller.mode is Mode.STANDING


_REPEAT = """
import sys
sys.path.insert(0, sys.argv[1])
from humanoid.trials.harness import Lockstep
from humanoid.simulation.sim import Noise
robot = Lockstep(seed=int(sys.argv[2]), noise=Noise())
robot.planner.velocity(0.2, 0.0, 0.0)
robot.run(3.0)
print(robot.simulator.hash())
"""


@pytest.mark.slow
def test_equal_seeds_make_equal_runs(model: HumanoidModel) -> None:
    examples = str(Path(__file__).parents[2] / "examples/humanoid")

    def other_process(seed: int) -> str:
        command = [sys.executable, "-c", _REPEAT, examples, str(seed)]
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout.strip()

    def here(seed: int) -> str:
        robot = Lockstep(model, seed=seed, noise=NOISE)
        robot.planner.velocity(0.2, 0.0, 0.0)
        robot.run(3.0)
        return robot.simulator.hash()

    assert here(1) == here(1) == other_process(1)
    assert here(1) != here(2)

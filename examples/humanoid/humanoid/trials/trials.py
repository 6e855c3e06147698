"""Trials that tests and benchmarks share: pushes, and walks to goals drawn at random."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..control.pace import Pace
from ..control.reference import straight_steps
from ..data import FootstepPlan
from ..planning.navigation import Navigation
from ..planning.walks import Outcome, WalkResult
from ..robot.model import HumanoidModel
from ..robot.table import STANCE_WIDTH
from ..seeds import generator
from ..simulation.sim import Noise
from .harness import Lockstep

_LENGTH = Pace().step_length
STRAIGHT = FootstepPlan(1, straight_steps(12, _LENGTH, STANCE_WIDTH), (11 * _LENGTH, 0.0, 0.0))
"""Twelve steps straight ahead at the usual speed."""

_PUSH_TIME = 0.1  # seconds
BETWEEN_PUSHES = 2.0  # seconds: two or three steps
_LONGEST_WALK = 90.0


def push(robot: Lockstep, direction: float, momentum: float) -> None:
    """Push the torso for 0.1 s: direction in degrees from x towards y, momentum in N s."""
    angle = math.radians(direction)
    robot.simulator.push(
        np.array([math.cos(angle), math.sin(angle), 0.0]) * momentum / _PUSH_TIME, _PUSH_TIME
    )


def navigate(
    robot: Lockstep, goal: tuple[float, float, float], momentum: float = 0.0, seed: int = 0
) -> WalkResult | None:
    """Walk to a goal as the navigation server does, pushed every two seconds; None if it takes too long."""
    random = generator(seed, "pushes")
    robot.run(0.02)
    assert robot.gait is not None
    navigation = Navigation(goal, robot.gait)
    began = pushed = robot.time
    while robot.time - began < _LONGEST_WALK:
        robot.tick()
        if momentum and robot.time - pushed > BETWEEN_PUSHES:
            push(robot, random.uniform(0.0, 360.0), momentum)
            pushed = robot.time
        tick = navigation.update(robot.gait)
        if tick.plan is not None:
            robot.planner.walk(tick.plan)
        if tick.result is not None:
            return tick.result
    return None


@dataclass(slots=True)
class Trial:
    """The results of many goals; errors are true ones, in metres and radians."""

    falls: int = 0
    reached: int = 0
    steps: int = 0
    errors: list[float] = field(default_factory=list)


def random_goals(
    model: HumanoidModel, goals: int, momentum: float, seed: int, noise: Noise | None = None
) -> Trial:
    """Walk to goals within 2 m of the origin, one after another; start again after a fall."""
    random = generator(seed, "goals")
    trial = Trial()
    robot = Lockstep(model, seed=seed, noise=noise or Noise())
    robot.run(0.5)
    for number in range(goals):
        x, y, yaw = random.uniform((-2.0, -2.0, -math.pi), (2.0, 2.0, math.pi))
        result = navigate(robot, (x, y, yaw), momentum, seed + number)
        if robot.fell:
            trial.falls += 1
            robot = Lockstep(model, seed=seed + number, noise=noise or Noise())
            robot.run(0.5)
        elif result is not None:
            trial.reached += result.outcome is Outcome.REACHED
            trial.steps += result.steps
            trial.errors.append(robot.distance_to((x, y, yaw)))
    return trial

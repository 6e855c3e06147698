"""Walks as WalkTo.action tells of them: tolerances, feedback, and how they ended."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from ..data import FootstepPlan, GaitState, Mode
from ..spatial import Array

STOPPED = {Mode.HOLDING, Mode.EMERGENCY_STOP}


def halted(gait: GaitState) -> str:
    """The reason why the robot accepts no goals now, or ""."""
    if gait.mode not in STOPPED | {Mode.FALLEN}:
        return ""
    return f"the robot accepts no goals: {gait.reason}"


class GoalTolerance(NamedTuple):
    """The errors that count as arrived: metres and radians."""

    position: float = 0.03
    yaw: float = 0.05


class Outcome(IntEnum):
    """The outcome of a walk, as in WalkTo.action."""

    UNKNOWN = 0
    REACHED = 1
    MISSED = 2
    CANCELED = 3
    PREEMPTED = 4
    UNREACHABLE = 5
    STOPPED = 6
    FELL = 7


@dataclass(frozen=True, slots=True)
class WalkFeedback:
    """The feedback of WalkTo.action."""

    pose: Array  # planar pose of base_footprint
    distance_left: float
    replanning: bool
    steps_taken: int
    steps_left: int


@dataclass(frozen=True, slots=True)
class WalkResult:
    """The result of WalkTo.action; `time` in seconds."""

    outcome: Outcome
    message: str
    pose: Array
    steps: int
    time: float


@dataclass(frozen=True, slots=True)
class WalkTick:
    """The messages to send after an update: a plan for the gait planner, or a request to stop."""

    plan: FootstepPlan | None
    stop: bool
    feedback: WalkFeedback
    result: WalkResult | None

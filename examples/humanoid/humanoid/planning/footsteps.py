"""Plans footsteps to a goal: turn towards it, walk, and settle into it; or tells why there are none.

The body moves as a planar pose, within the limits of a step. Each step puts one foot beside the body's new
pose.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from ..control.pace import SHORTEST_TIME, Pace
from ..data import Footstep, FootstepPlan, Leg, Stance
from ..robot.body import OURS, STRAIGHT_HEIGHT, Body
from ..robot.ground import Ground
from ..robot.table import STANCE_WIDTH
from ..spatial import Array, from_frame, to_frame, wrap

_SLACK = 0.02  # metres by which feet land beside their places in an ordinary walk


class PlanStatus(IntEnum):
    """The outcome of planning, as in PlanFootsteps.srv."""

    UNKNOWN = 0
    PLANNED = 1
    ALREADY_THERE = 2
    TOO_FAR = 3
    BLOCKED = 4
    UNKNOWN_FRAME = 5
    INVALID_REQUEST = 6


@dataclass(frozen=True, slots=True)
class StepLimits:
    """Limits of a step. Lengths in metres, angles in radians, times in seconds."""

    forward: float = Pace().step_length
    backward: float = 0.10
    sideways: float = 0.06  # by the leg on that side; the other one follows
    turn: float = 0.30  # by the leg on that side
    trailing_turn: float = 0.15
    near: float = 0.45  # within this distance the robot turns to the goal's yaw, no longer towards the goal
    width: float = STANCE_WIDTH
    step_time: float = Pace().step_time
    most: int = 512  # steps that a plan can hold

    def at_pace(self, pace: Pace) -> StepLimits:
        """The same limits for a walk at another speed."""
        return replace(self, forward=pace.step_length, step_time=pace.step_time)


def shorter(limits: StepLimits, length: float) -> StepLimits:
    """The limits with forward steps of at most `length` [m]; 0 leaves them as they are."""
    return replace(limits, forward=min(limits.forward, length)) if length else limits


def fitted(limits: StepLimits, body: Body) -> StepLimits:
    """The limits that are as large for the legs of another body as these are for ours.

    Legs that cannot bend as deep as ours take shorter steps.
    """
    if body is OURS:
        return limits
    scale = body.scale
    fastest = Pace.no_lower_than(STRAIGHT_HEIGHT - body.crouch / scale)
    return replace(
        limits,
        forward=min(limits.forward, fastest.step_length) * scale,
        backward=limits.backward * scale,
        sideways=limits.sideways * scale,
        near=limits.near * scale,
        width=limits.width * body.stance_width / OURS.stance_width,
    )


@dataclass(frozen=True, slots=True)
class PlanResult:
    """The response of PlanFootsteps: a plan, or why there is none."""

    status: PlanStatus
    message: str
    plan: FootstepPlan


def beside(base: Array, leg: Leg, width: float = STANCE_WIDTH) -> Array:
    """Planar pose of a leg's sole when the body is at a planar pose."""
    x, y = from_frame(base, np.array([0.0, leg.sign * width / 2]))
    return np.array([x, y, base[2]])


def footstep(index: int, leg: Leg, base: Array, limits: StepLimits) -> Footstep:
    """The step that puts a leg beside the body's planar pose."""
    x, y, yaw = (float(part) for part in beside(base, leg, limits.width))
    return Footstep(index, leg, x, y, yaw, limits.step_time)


def is_easy(start: Stance, first: Footstep, limits: StepLimits) -> bool:
    """Whether a first step lands no farther from the other foot than a step straight ahead does.

    After a walk that was broken off, one foot is ahead: it must not take the first step, away from the other.
    """
    away = math.hypot(*(first.pose - start.feet[first.leg.other.side])[:2])
    return away < math.hypot(limits.forward, limits.width) + _SLACK


def advance(base: Array, leg: Leg, motion: Sequence[float] | Array, limits: StepLimits) -> Array:
    """The body's planar pose after a step of this leg: moved by (forward, left, turn), within its limits.

    A leg cannot step across the other one. Only the leg on the side of the motion moves sideways or makes a
    full turn. A step that turns goes half as far aside, and one that does either, half as far ahead.
    """
    forward, left, turn = motion
    most = limits.turn if turn * leg.sign > 0 else limits.trailing_turn
    turn = min(max(turn, -most), most)
    room = 1.0 - 0.5 * abs(turn) / limits.turn
    aside = room * limits.sideways
    left = min(max(left, -aside), aside) if left * leg.sign > 0 else 0.0
    room *= 1.0 - 0.5 * abs(left) / aside if aside > 0 else 1.0
    forward = min(max(forward, -room * limits.backward), room * limits.forward)
    x, y = from_frame(base, np.array([forward, left]))
    return np.array([x, y, base[2] + turn])


def plan_footsteps(
    start: Stance,
    goal: tuple[float, float, float],
    *,
    limits: StepLimits | None = None,
    ground: Ground | None = None,
    first_leg: Leg | None = None,
    first_index: int = 0,
) -> PlanResult:
    """Plan the steps from a stance to a planar pose of base_footprint."""
    limits, ground = limits or StepLimits(), ground or Ground()
    nothing = FootstepPlan(0, (), goal)
    if problem := _invalid(start, goal, limits):
        return PlanResult(PlanStatus.INVALID_REQUEST, problem, nothing)
    if problem := ground.problem(goal[0], goal[1]):
        return PlanResult(PlanStatus.BLOCKED, f"the goal {problem}", nothing)
    if _there(start, goal, limits):
        return PlanResult(PlanStatus.ALREADY_THERE, "the feet are already at the goal", nothing)
    legs = [first_leg] if first_leg else [Leg.RIGHT, Leg.LEFT]
    plans = [steps for leg in legs if (steps := _steps(start.centre, goal, leg, limits, first_index))]
    if not plans:
        distance = math.hypot(goal[0] - start.centre[0], goal[1] - start.centre[1])
        message = f"the goal is {distance:.1f} m away: more than the {limits.most} steps that a plan can hold"
        return PlanResult(PlanStatus.TOO_FAR, message, nothing)
    steps = min(plans, key=lambda steps: (not is_easy(start, steps[0], limits), len(steps)))
    for step in steps:
        if problem := ground.problem(step.x, step.y):
            message = f"step {step.index - first_index + 1} of {len(steps)}: {problem}"
            return PlanResult(PlanStatus.BLOCKED, message, nothing)
    return PlanResult(PlanStatus.PLANNED, "", FootstepPlan(0, tuple(steps), goal))


def _steps(
    base: Array, goal: tuple[float, float, float], leg: Leg, limits: StepLimits, index: int
) -> list[Footstep] | None:
    """The steps of a walk that this leg begins; None if there are too many."""
    steps: list[Footstep] = []
    while not _close(base, goal):
        if len(steps) >= limits.most - 1:
            return None
        base = advance(base, leg, _motion(base, goal, limits), limits)
        steps.append(footstep(index + len(steps), leg, base, limits))
        leg = leg.other
    steps.append(footstep(index + len(steps), leg, base, limits))
    return steps


def _motion(base: Array, goal: tuple[float, float, float], limits: StepLimits) -> tuple[float, float, float]:
    """The next motion of the body, in its own frame: (forward, left, turn)."""
    dx, dy = goal[0] - base[0], goal[1] - base[1]
    if math.hypot(dx, dy) > limits.near:
        error = wrap(math.atan2(dy, dx) - base[2])
        ahead = math.hypot(dx, dy) * math.cos(error)
        return min(ahead, limits.forward) * max(0.0, math.cos(error)), 0.0, error
    forward, left = to_frame(base, np.array(goal[:2]))
    return float(forward), float(left), wrap(goal[2] - base[2])


def _close(base: Array, goal: tuple[float, float, float]) -> bool:
    return math.hypot(goal[0] - base[0], goal[1] - base[1]) < 1e-3 and abs(wrap(goal[2] - base[2])) < 1e-3


def _there(start: Stance, goal: tuple[float, float, float], limits: StepLimits) -> bool:
    """Whether both feet are already where the goal wants them, within 5 mm and 0.01 rad."""
    return all(
        math.hypot(*(foot - wanted)[:2]) < 5e-3 and abs(wrap(foot[2] - wanted[2])) < 0.01
        for foot, wanted in (
            (start.feet[leg.side], beside(np.array(goal), leg, limits.width)) for leg in (Leg.LEFT, Leg.RIGHT)
        )
    )


def _invalid(start: Stance, goal: tuple[float, float, float], limits: StepLimits) -> str:
    """The first error in a request, or ""."""
    if not all(map(math.isfinite, goal)):
        return "the goal holds a number that is not finite"
    if not all(np.isfinite(foot).all() for foot in start.feet):
        return "the stance holds a number that is not finite"
    apart = math.hypot(*(start.feet[0] - start.feet[1])[:2])
    if not 0.08 < apart < 0.7:
        return f"the soles of the stance are {apart:.2f} m apart; a stance has 0.08 to 0.7 m"
    if not (limits.forward > 0 and SHORTEST_TIME <= limits.step_time <= 3.0):
        return f"a step needs a length above 0 and {SHORTEST_TIME:g} to 3 s"
    return ""

"""Footsteps along a route: towards a point that moves ahead of the body, until it faces the goal."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from ..data import Footstep, Leg, Stance, Support
from ..robot.grid import nearest
from ..spatial import Array, wrap
from .footsteps import StepLimits, advance, beside, footstep, is_easy

AHEAD = 0.30
"""How far ahead of the body the point is that it walks to, at least [m]; a long step looks farther."""

NEAREST = 0.38
"""No step takes the body nearer to an obstacle than this [m], unless it leads away from it.

The hands are 0.27 m aside, the body sways by 0.05 m, and the map errs by as much.
"""

TURN, SHARP_TURN = 0.7, 0.15
"""How far beside the way the body only turns [rad]; the nearer to that, the shorter its steps."""

_ALIGNED = 0.2  # rad beside the last line up to which the rest of the way is walked straight


def steps_to_last_line(
    start: Stance,
    route: Sequence[tuple[float, float]],
    limits: StepLimits,
    first_leg: Leg | None,
    first_index: int,
    turn: float = TURN,
) -> tuple[list[Footstep], Stance]:
    """The steps along a route until the body faces the goal on its last line, and the stance after them.

    The first place of the route is where the body is. A route of one line needs no steps. The body only turns
    when it faces more than `turn` [rad] beside the way.
    """
    if len(route) < 3:
        return [], start
    leg = first_leg or _first_leg(start.centre, route)
    steps = _steps_of(leg, start.centre, route, limits, first_index, turn)
    if steps and not first_leg and not is_easy(start, steps[0], limits):
        steps = _steps_of(leg.other, start.centre, route, limits, first_index, turn)
    feet = list(start.feet)
    for step in steps[-2:]:
        feet[step.leg.side] = step.pose
    return steps, Stance(Support.BOTH, (feet[0], feet[1])) if steps else start


def _steps_of(
    leg: Leg,
    base: Array,
    route: Sequence[tuple[float, float]],
    limits: StepLimits,
    first_index: int,
    turn: float,
) -> list[Footstep]:
    """The steps of a walk along a route that this leg begins."""
    steps: list[Footstep] = []
    lengths = [0.0, *itertools.accumulate(itertools.starmap(math.dist, itertools.pairwise(route)))]
    along = 0.0
    while len(steps) < limits.most // 2:
        along = max(along, _project(base, route, lengths, along))
        heading = math.atan2(route[-1][1] - base[1], route[-1][0] - base[0])
        if along >= lengths[-2] and abs(wrap(heading - base[2])) < _ALIGNED:
            break
        if lengths[-1] - along < limits.near:
            break
        target = _at(route, lengths, along + max(AHEAD, limits.forward))
        base = advance(base, leg, _motion(base, target, limits, turn), limits)
        steps.append(footstep(first_index + len(steps), leg, base, limits))
        leg = leg.other
    return steps


def blocked_step(steps: Sequence[Footstep], points: Array, base: Array, limits: StepLimits) -> str:
    """The first of the steps that takes the body too near to points (n, 2), in words, or ""."""
    before = float(nearest(points, base[None, :2])[0])
    for number, step in enumerate(steps, 1):
        middle = body_of(step, limits)[None, :2]
        room = float(nearest(points, middle)[0])
        if room < min(NEAREST, before - 1e-3):
            return f"step {number} of {len(steps)} is {room:.2f} m from an obstacle"
        before = room
    return ""


def body_of(step: Footstep, limits: StepLimits) -> Array:
    """The planar pose of the body beside a step."""
    return beside(step.pose, step.leg.other, limits.width)


def _first_leg(base: Array, route: Sequence[tuple[float, float]]) -> Leg:
    """The leg on the side to which the route leads: it can turn farther."""
    error = wrap(math.atan2(route[1][1] - base[1], route[1][0] - base[0]) - base[2])
    return Leg.LEFT if error > 0 else Leg.RIGHT


def _motion(
    base: Array, target: tuple[float, float], limits: StepLimits, turn: float
) -> tuple[float, float, float]:
    """The next motion of the body in its own frame: towards a point, turning first if that is beside it."""
    error = wrap(math.atan2(target[1] - base[1], target[0] - base[0]) - base[2])
    forward = limits.forward * max(0.0, 1.0 - abs(error) / turn)
    return forward, 0.0, error


def _project(
    base: Array, route: Sequence[tuple[float, float]], lengths: Sequence[float], begin: float
) -> float:
    """How far along the route its nearest place is, within the next metre from `begin` on."""
    candidates = np.arange(begin, min(begin + 1.0, lengths[-1]), 0.02)
    places = np.array([_at(route, lengths, float(along)) for along in candidates])
    return float(candidates[np.argmin(np.hypot(places[:, 0] - base[0], places[:, 1] - base[1]))])


def _at(route: Sequence[tuple[float, float]], lengths: Sequence[float], along: float) -> tuple[float, float]:
    """The place at a distance along the route."""
    for number in range(1, len(route)):
        if along <= lengths[number] or number == len(route) - 1:
            span = max(lengths[number] - lengths[number - 1], 1e-9)
            share = min(max((along - lengths[number - 1]) / span, 0.0), 1.0)
            (x, y), (to_x, to_y) = route[number - 1], route[number]
            return x + share * (to_x - x), y + share * (to_y - y)
    return route[-1]

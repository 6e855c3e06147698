"""Whether a velocity leads into an obstacle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..data import Leg
from ..robot.grid import nearest
from ..spatial import Array
from .footsteps import StepLimits, advance


class Ahead(NamedTuple):
    """How far to look: a number of steps, the clearance [m], and the time between two steps [s]."""

    horizon: int
    clearance: float
    double_support: float


def free_ahead(
    base: Array,
    velocity: tuple[float, float, float],
    points: Array,
    limits: StepLimits,
    ahead: Ahead,
) -> bool:
    """Whether the next steps at a velocity (m/s, m/s, rad/s) stay away from points (n, 2).

    A body (planar pose `base`) that is already within the clearance [m] may move away from what is there.
    """
    motion = np.array(velocity) * (limits.step_time + ahead.double_support)
    motion[1] *= 2  # only every other step moves sideways
    before = float(nearest(points, base[None, :2])[0])
    leg = Leg.LEFT if motion[1] > 0 or motion[2] > 0 else Leg.RIGHT
    for _ in range(ahead.horizon):
        base = advance(base, leg, motion, limits)
        room = float(nearest(points, base[None, :2])[0])
        if room < min(ahead.clearance, before - 1e-3):
            return False
        before, leg = room, leg.other
    return True

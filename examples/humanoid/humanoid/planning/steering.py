"""Whether a velocity leads into an obstacle."""

from __future__ import annotations

import numpy as np

from ..data import Leg
from ..robot.grid import nearest
from ..spatial import Array
from .footsteps import StepLimits, advance

_DOUBLE_SUPPORT = 0.2  # s between two steps


def free_ahead(
    base: Array,
    velocity: tuple[float, float, float],
    points: Array,
    limits: StepLimits,
    horizon: int,
    clearance: float,
) -> bool:
    """Whether the next steps at a velocity (m/s, m/s, rad/s) stay away from points (n, 2).

    A body (planar pose `base`) that is already within the clearance [m] may move away from what is there.
    """
    motion = np.array(velocity) * (limits.step_time + _DOUBLE_SUPPORT)
    motion[1] *= 2  # only every other step moves sideways
    before = float(nearest(points, base[None, :2])[0])
    leg = Leg.LEFT if motion[1] > 0 or motion[2] > 0 else Leg.RIGHT
    for _ in range(horizon):
        base = advance(base, leg, motion, limits)
        room = float(nearest(points, base[None, :2])[0])
        if room < min(clearance, before - 1e-3):
            return False
        before, leg = room, leg.other
    return True

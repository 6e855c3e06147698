"""The foot in the air: its path, and where it lands after a push."""

from __future__ import annotations

import math

import numpy as np

from ..spatial import Array, from_frame, to_frame

_FORWARD = (-0.30, 0.45)  # of the landing, relative to the stance foot, metres
_OUTWARD = (0.13, 0.42)
FLOOR = 0.3
_SPEED = 1.5  # speed at which the landing moves, m/s
_TOLERATED = 0.6  # share of the error that the sole can correct; only a larger error moves the landing


def travelled(phase: float) -> float:
    """Share of its way that the foot has covered."""
    return phase**3 * (10 - 15 * phase + 6 * phase * phase)


def foot_pose(start: Array, landing: Array, phase: float, lift: float) -> tuple[Array, float]:
    """Planar pose (3,) and height of the sole on its way from start to landing; `phase` is 0 to 1.

    Velocity and acceleration are 0 at both ends.
    """
    share = travelled(phase)
    return start + (landing - start) * share, lift * 64 * (phase * (1 - phase)) ** 3


def acceleration(start: Array, landing: Array, phase: float, left: float, lift: float) -> Array:
    """The acceleration (6,) of the sole on the way of `foot_pose`, linear then angular.

    `left` is the time until it lands [s].
    """
    rate = (1.0 - phase) / max(left, 0.05)
    share = 60 * phase - 180 * phase**2 + 120 * phase**3
    both = phase * (1 - phase)
    height = 64 * (6 * both * (1 - 2 * phase) ** 2 - 6 * both**2)
    x, y, yaw = (landing - start) * share
    return rate**2 * np.array([x, y, lift * height, 0.0, 0.0, yaw])


def adjusted_landing(
    planned: Array, stance: Array, sign: int, error: Array, room: tuple[Array, Array], growth: float
) -> Array:
    """The point (2,) to land at, instead of `planned` (2,), to catch a robot whose DCM is off.

    `stance` is the planar pose of the other foot, `sign` says which side the swinging leg is on, `error` (2,)
    is the DCM's, `room` how far the ZMP can still move back and forth in the stance sole (2,) each, and
    `growth` the factor by which an error grows until touchdown. Returns `planned` itself if the sole can
    correct the error.
    """
    turned = to_frame(np.array([0.0, 0.0, stance[2]]), error)
    shift = np.zeros(2)
    for axis in (0, 1):
        limit = _TOLERATED * (room[1] if turned[axis] > 0 else room[0])[axis]
        if abs(turned[axis]) > abs(limit):
            shift[axis] = (turned[axis] - limit) * growth
    if not shift.any():
        return planned
    return from_frame(stance, within_reach(to_frame(stance, planned) + shift, sign))


def within_reach(landing: Array, sign: int) -> Array:
    """The nearest point (2,) to a landing (2,) that a leg reaches, both in the frame of the stance foot."""
    x, y = landing
    x = min(max(x, _FORWARD[0]), _FORWARD[1])
    y = sign * min(max(sign * y, _OUTWARD[0]), _OUTWARD[1])
    return np.array([x, y])


def moved(landing: Array, target: Array, phase: float, period: float) -> Array:
    """The landing (2,), moved towards a target (2,) as far as is allowed within a control period [s].

    The foot moves with it by the share of its way that it has covered, and a leg that is thrown sideways
    throws the body the other way.
    """
    way = target - landing
    length = math.hypot(way[0], way[1])
    most = _SPEED / max(travelled(phase), FLOOR) * period
    return target if length <= most else landing + way * (most / length)


def not_inwards(landing: Array, target: Array, stance: Array, sign: int) -> Array:
    """The target (2,) for a landing (2,), but sideways no nearer to the stance foot than the landing.

    The next step can correct a landing that is too far out, but not one that is too near.
    """
    x, y = to_frame(stance, target)
    out = max(sign * y, sign * to_frame(stance, landing)[1])
    return from_frame(stance, np.array([x, sign * out]))

"""Estimates how a body is turned, from a gyroscope that drifts and an accelerometer that feels every step.

The gyroscope is integrated; gravity, as the accelerometer feels it on average, corrects roll and pitch slowly
(a complementary filter, after R. Mahony). Nothing corrects the heading while the body moves. While it rests,
the gyroscope's mean is its bias, about all three axes.
"""

from __future__ import annotations

import math

import numpy as np

from ..robot.model import GRAVITY
from ..spatial import Array

_CORRECTION = 0.05  # 1/s: how fast gravity corrects roll and pitch while the body moves
_SETTLING = 0.2  # 1/s: the same while it rests
_LEARNING = _CORRECTION**2 / 4  # 1/s2: the same for the bias, without overshoot
# The body rests when it has turned more slowly, and accelerated less, for a time [rad/s, m/s2, s]. The first
# time, a short rest counts: nothing is known yet.
_RESTING_RATE, _RESTING_ACCELERATION, _RESTING, _FIRST, _ENOUGH = 0.05, 0.3, 0.5, 0.1, 0.3
_WINDOW = 10.0  # s of rest over which the readings are averaged
_MOST = 0.03  # rad/s: no gyroscope's bias is larger

Vector = tuple[float, float, float]


class AttitudeEstimator:
    """Orientation of a sensor and bias of its gyroscope, from its own readings. The heading begins at 0."""

    def __init__(self) -> None:
        self._turn = (0.0, 0.0, 0.0, 1.0)  # quaternion (x, y, z, w), from the body to the world
        self._bias: Vector = (0.0, 0.0, 0.0)
        self.stamp: int | None = None  # of the last readings
        self._rest = 0.0  # s
        self._averaged = 0.0  # s of rest, at most the window

    @property
    def orientation(self) -> Array:
        """Quaternion (4,) from the axes of the body to those of the world."""
        return np.array(self._turn)

    @property
    def bias(self) -> Array:
        """The estimate of the gyroscope's bias (3,) [rad/s]."""
        return np.array(self._bias)

    def update(self, stamp: int, rate: Array, acceleration: Array) -> None:
        """Take the mean readings since the last moment [ns, rad/s, m/s2]: (3,) each, in the body's axes."""
        p, q, r = rate.tolist()
        ax, ay, az = acceleration.tolist()
        if self.stamp is None:
            self.stamp = stamp
            if abs(math.hypot(ax, ay, az) - GRAVITY) < _RESTING_ACCELERATION:
                self._turn = _upright(ax, ay, az)
            return
        elapsed, self.stamp = (stamp - self.stamp) * 1e-9, stamp
        x, y, z, w = self._turn
        # Upwards, as the body sees it, and the turn from there to what the accelerometer takes for upwards.
        ux, uy, uz = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
        ex, ey, ez = ((ay * uz - az * uy), (az * ux - ax * uz), (ax * uy - ay * ux))
        strange = math.hypot(ax - GRAVITY * ux, ay - GRAVITY * uy, az - GRAVITY * uz)
        bx, by, bz = self._bias
        resting = math.hypot(p, q, r) < _RESTING_RATE and strange < _RESTING_ACCELERATION
        self._rest = self._rest + elapsed if resting else 0.0
        if self._rest > (_FIRST if self._averaged < _ENOUGH else _RESTING):
            self._averaged = min(self._averaged + elapsed, _WINDOW)
            share = elapsed / self._averaged
            bx, by, bz = bx + share * (p - bx), by + share * (q - by), bz + share * (r - bz)
            correction = _SETTLING * elapsed / GRAVITY
        else:
            correction = _CORRECTION * elapsed / GRAVITY
            learnt = _LEARNING * elapsed / GRAVITY
            bx, by, bz = bx - learnt * ex, by - learnt * ey, bz - learnt * ez
        self._bias = (_within(bx), _within(by), _within(bz))
        self._turn = _turned(
            self._turn,
            (p - bx) * elapsed + correction * ex,
            (q - by) * elapsed + correction * ey,
            (r - bz) * elapsed + correction * ez,
        )


def _within(bias: float) -> float:
    return min(max(bias, -_MOST), _MOST)


def _upright(x: float, y: float, z: float) -> tuple[float, float, float, float]:
    """The turn of a body with heading 0 that feels this acceleration because of gravity alone."""
    roll, pitch = math.atan2(y, z) / 2, math.atan2(-x, math.hypot(y, z)) / 2
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    return sr * cp, cr * sp, -sr * sp, cr * cp


def _turned(
    turn: tuple[float, float, float, float], a: float, b: float, c: float
) -> tuple[float, float, float, float]:
    """A quaternion after a small turn (a, b, c) about the body's axes [rad]."""
    x, y, z, w = turn
    angle = math.sqrt(a * a + b * b + c * c)
    size = 0.5 - angle * angle / 48  # sin(angle / 2) / angle
    a, b, c, d = size * a, size * b, size * c, 1 - angle * angle / 8
    x, y, z, w = (
        w * a + x * d + y * c - z * b,
        w * b + y * d + z * a - x * c,
        w * c + z * d + x * b - y * a,
        w * d - x * a - y * b - z * c,
    )
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return x / length, y / length, z / length, w / length

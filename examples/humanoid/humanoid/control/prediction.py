"""What happens until the servos obey: a controller that answers the present state comes too late."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from ..robot.model import SERVO_DELAY
from ..spatial import Array

DELAY = SERVO_DELAY * 1e-9
"""Seconds from a set-point to its torque."""

_SMOOTHING = 0.4  # weight of a new reading in the estimate of a push
_ORDINARY = 2.0  # m/s2 that are no push


class Prediction:
    """The velocity that the centre of mass gains within the servos' delay."""

    def __init__(self, omega: float, period: float) -> None:
        """`omega` is the natural frequency [1/s], `period` the control period [s]."""
        self._square, self._period = omega**2, period
        self._pressing: deque[Array] = deque(maxlen=round(DELAY / period))
        self._velocity: Array | None = None
        self._push = np.zeros(2)

    def press(self, zmp: Array) -> None:
        """Note the point (2,) away from which new set-points will accelerate the centre of mass."""
        self._pressing.append(zmp)

    def gained(self, com: Array, velocity: Array, standing: bool) -> Array:
        """The velocity (2,) gained, for the present centre of mass (2,) and velocity (2,) of the pelvis.

        The set-points on the way decide it, and whoever pushes a robot that stands on both feet: that is an
        acceleration that no set-point asked for.
        """
        accelerations = [self._square * (com - zmp) for zmp in self._pressing]
        if not accelerations:
            return np.zeros(2)
        if self._velocity is not None:
            found = (velocity - self._velocity) / self._period - accelerations[0]
            self._push += _SMOOTHING * (found - self._push)
        self._velocity = velocity.copy()
        strength = math.hypot(*self._push)
        push = self._push * max(0.0, 1 - _ORDINARY / strength) if standing and strength > 0 else np.zeros(2)
        return DELAY * push + self._period * sum(accelerations, np.zeros(2))

"""The inertial measurement unit: a gyroscope and an accelerometer with errors, and what it makes of them.

As most such units it estimates its own orientation, from nothing but its own readings, and corrects the rate
of turn by the bias that it has found.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..data import Imu
from ..robot.model import GRAVITY, PERIOD
from ..sensing.attitude import AttitudeEstimator
from ..spatial import Array

# The unit has lain still and level before the run, as when a robot is switched on.
_WARMING_UP = 5_000_000_000  # ns


@dataclass(frozen=True, slots=True)
class InertialErrors:
    """Standard deviations. The biases are drawn once for a run; that of the gyroscope then drifts."""

    rate: float = 0.005  # rad/s, of each reading
    rate_bias: float = 0.003  # rad/s
    rate_drift: float = 5e-5  # rad/s after a second; it grows with the root of time
    acceleration: float = 0.05  # m/s2, of each reading
    acceleration_bias: float = 0.03  # m/s2


MEMS = InertialErrors()
"""Those of a good unit on one chip."""


class InertialUnit:
    """Turns the true motion of its place into readings, one for each moment."""

    def __init__(self, errors: InertialErrors, random: np.random.Generator) -> None:
        self._errors = errors
        self._random = random
        self._rate_bias = errors.rate_bias * random.standard_normal(3)
        self._acceleration_bias = errors.acceleration_bias * random.standard_normal(3)
        self._attitude = AttitudeEstimator()
        self._reading: Imu | None = None
        for tick in range(_WARMING_UP // PERIOD):
            self._sample(tick * PERIOD - _WARMING_UP, np.zeros(3), np.array([0.0, 0.0, GRAVITY]))

    def read(self, stamp: int, rate: Array, acceleration: Array) -> Imu:
        """The reading of a moment [ns], from true mean values since the last one [rad/s, m/s2].

        Both are (3,) in the unit's axes. Asked again for the same moment it says the same.
        """
        if self._reading is not None and self._reading.stamp == stamp:
            return self._reading
        elapsed = 0.0 if self._reading is None else (stamp - self._reading.stamp) * 1e-9
        drift = self._errors.rate_drift * math.sqrt(elapsed)
        self._rate_bias = self._rate_bias + drift * self._random.standard_normal(3)
        turning, felt = self._sample(stamp, rate, acceleration)
        self._reading = Imu(stamp, self._attitude.orientation, turning - self._attitude.bias, felt)
        return self._reading

    def _sample(self, stamp: int, rate: Array, acceleration: Array) -> tuple[Array, Array]:
        """What gyroscope and accelerometer measure; the estimator of the orientation takes it."""
        errors, draw = self._errors, self._random.standard_normal
        turning = rate + self._rate_bias + errors.rate * draw(3)
        felt = acceleration + self._acceleration_bias + errors.acceleration * draw(3)
        self._attitude.update(stamp, turning, felt)
        return turning, felt

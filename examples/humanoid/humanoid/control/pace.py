"""How the robot walks at a speed: one number from which length, height and times of its steps follow.

They belong together. Long steps need a low centre of mass, or the legs are not long enough; and a robot that
falls from foot to foot quickly has little time on both feet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..data import STEP_TIME
from ..robot.table import STANCE_WIDTH

SLOWEST, FASTEST, USUAL = 0.1, 0.6, 0.5  # m/s
# What walks best at these speeds [m/s], between which the others lie: time from lift-off to touchdown and on
# both feet [s], and the height of the centre of mass [m].
_SPEEDS = (0.225, 0.5, 0.6)
_STEP_TIMES = (STEP_TIME, STEP_TIME, 0.50)
_DOUBLE_SUPPORTS = (0.20, 0.10, 0.10)
_HEIGHTS = (0.70, 0.62, 0.62)
_SPARE = 0.25  # metres between the soles, beyond a step straight ahead, for steps that also turn or go aside
SHORTEST_TIME = 0.4  # seconds from lift-off to touchdown: legs that swing faster throw the robot over


@dataclass(frozen=True, slots=True)
class Pace:
    """A walking speed [m/s], straight ahead, and what follows from it. ValueError if no legs can do it."""

    speed: float = USUAL

    def __post_init__(self) -> None:
        if not SLOWEST <= self.speed <= FASTEST:
            raise ValueError(f"the robot walks at {SLOWEST:g} to {FASTEST:g} m/s, not at {self.speed:g}")

    @classmethod
    def no_lower_than(cls, height: float) -> Pace:
        """The fastest walk at which the centre of mass, with legs as long as ours, is at this height [m]."""
        return cls(float(np.interp(-height, [-h for h in _HEIGHTS], _SPEEDS)))

    @property
    def step_time(self) -> float:
        """Time from lift-off to touchdown [s]."""
        return float(np.interp(self.speed, _SPEEDS, _STEP_TIMES))

    @property
    def double_support(self) -> float:
        """Time on both feet between two steps [s]."""
        return float(np.interp(self.speed, _SPEEDS, _DOUBLE_SUPPORTS))

    @property
    def step_length(self) -> float:
        """Distance from one foot to the landing of the other, forwards [m]."""
        return self.speed * (self.step_time + self.double_support)

    @property
    def reach(self) -> float:
        """Distance between the soles that a step may make at most [m]."""
        return max(self.step_length, STANCE_WIDTH) + _SPARE

    @property
    def com_height(self) -> float:
        """Height of the centre of mass above the soles, with legs as long as ours [m]."""
        return float(np.interp(self.speed, _SPEEDS, _HEIGHTS))

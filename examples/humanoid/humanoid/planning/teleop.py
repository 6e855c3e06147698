"""Velocities from a person's hand: limited, smoothed, and zero when the messages stop."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..data import SECOND

TIMEOUT = 500_000_000  # ns, unless the caller sets another one


@dataclass(frozen=True, slots=True)
class VelocityLimits:
    """The highest velocity of the gait, and how fast a velocity may change."""

    forward: float = 0.22  # m/s
    backward: float = 0.12
    sideways: float = 0.035
    turn: float = 0.25  # rad/s
    acceleration: float = 0.4  # m/s2
    turn_acceleration: float = 0.8  # rad/s2


class Teleop:
    """Turns cmd_vel as it arrives into velocities that the gait planner can follow."""

    def __init__(self, limits: VelocityLimits | None = None, timeout: int = TIMEOUT) -> None:
        """Rest; after `timeout` [ns] without a message the velocity is zero."""
        self._timeout = timeout
        self._limits = limits or VelocityLimits()
        self._wanted = (0.0, 0.0, 0.0)
        self._now = (0.0, 0.0, 0.0)
        self._heard: int | None = None
        self._updated: int | None = None
        self.refused = 0  # messages that did not hold finite numbers

    def command(self, forward: float, left: float, turn: float, stamp: int) -> bool:
        """Take a message; False if it is refused."""
        if not all(map(math.isfinite, (forward, left, turn))):
            self.refused += 1
            return False
        limits = self._limits
        self._wanted = (
            min(max(forward, -limits.backward), limits.forward),
            min(max(left, -limits.sideways), limits.sideways),
            min(max(turn, -limits.turn), limits.turn),
        )
        self._heard = stamp
        return True

    def update(self, stamp: int) -> tuple[float, float, float]:
        """The velocity to walk at now: (m/s, m/s, rad/s); zero when time has gone back."""
        if self._updated is not None and stamp < self._updated:
            self._now, self._heard = (0.0, 0.0, 0.0), None
        if self._heard is None or stamp - self._heard > self._timeout:
            self._wanted = (0.0, 0.0, 0.0)
        seconds = 0.0 if self._updated is None else max(stamp - self._updated, 0) / SECOND
        self._updated = stamp
        most = (self._limits.acceleration, self._limits.acceleration, self._limits.turn_acceleration)
        forward, left, turn = (
            now + min(max(wanted - now, -rate * seconds), rate * seconds)
            for now, wanted, rate in zip(self._now, self._wanted, most, strict=True)
        )
        self._now = (forward, left, turn)
        return self._now

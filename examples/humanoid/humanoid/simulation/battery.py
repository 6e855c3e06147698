"""The battery: a pack that the motors drain, and a monitor that says when to stop."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..data import SECOND, JointStates

_AMBIENT = 25.0  # degC


@dataclass(slots=True)
class BatteryReading:
    """sensor_msgs/BatteryState: volts, amperes (negative: discharging), charge 0 to 1, degrees Celsius."""

    stamp: int
    voltage: float
    current: float
    charge: float
    temperature: float


class BatteryPack:
    """Thirteen lithium cells in series, with their resistance and heat; `capacity` is in Wh."""

    def __init__(self, charge: float = 1.0, capacity: float = 500.0, idle_power: float = 60.0) -> None:
        self.charge, self._capacity, self._idle = charge, capacity, idle_power
        self._temperature = _AMBIENT
        self._last: int | None = None

    def update(self, joints: JointStates) -> BatteryReading:
        """Take the joints' state; returns what a fuel gauge would read."""
        seconds = 0.0 if self._last is None else (joints.stamp - self._last) / SECOND
        self._last = joints.stamp
        moving = float(np.abs(joints.effort * joints.velocity).sum())
        heat = 0.05 * float(np.square(joints.effort).sum())  # in the windings
        power = self._idle + moving / 0.8 + heat
        open_circuit = 13 * (3.2 + 0.9 * self.charge)
        current = power / open_circuit
        self.charge = max(0.0, self.charge - power * seconds / (3600 * self._capacity))
        self._temperature += seconds * (0.05 * current**2 - 0.5 * (self._temperature - _AMBIENT)) / 900
        return BatteryReading(
            joints.stamp, open_circuit - 0.05 * current, -current, self.charge, self._temperature
        )


class Level(IntEnum):
    """The level of the battery, as in BatteryStatus.msg."""

    UNKNOWN = 0
    NORMAL = 1
    LOW = 2
    CRITICAL = 3


@dataclass(frozen=True, slots=True)
class BatteryLimits:
    """Limits between levels: charge 0 to 1, temperature in degrees Celsius, age of a reading in ns."""

    low: float = 0.25
    critical: float = 0.10
    margin: float = 0.03  # by which the charge must rise before a level is left
    hottest: float = 60.0
    oldest: int = 5 * SECOND


@dataclass(slots=True)
class BatteryVerdict:
    """The contents of BatteryStatus.msg: the level, and the seconds until empty (0: not known)."""

    level: Level
    charging: bool
    time_left: float
    reading: BatteryReading | None


class BatteryMonitor:
    """Judges readings. Without one, or with an old one, the level is unknown."""

    def __init__(self, limits: BatteryLimits | None = None) -> None:
        self._limits = limits or BatteryLimits()
        self._level = Level.UNKNOWN
        self._reading: BatteryReading | None = None
        self._drain = 0.0  # charge per second, smoothed

    def take(self, reading: BatteryReading) -> None:
        """Take a reading; one that is not finite is ignored."""
        if not (math.isfinite(reading.charge) and math.isfinite(reading.voltage)):
            return
        if self._reading is not None and reading.stamp > self._reading.stamp:
            seconds = (reading.stamp - self._reading.stamp) / SECOND
            drain = (self._reading.charge - reading.charge) / seconds
            self._drain += min(1.0, seconds / 10.0) * (drain - self._drain)
        self._reading = reading

    def verdict(self, now: int) -> BatteryVerdict:
        """The level now, with hysteresis between falling and rising."""
        reading, limits = self._reading, self._limits
        if reading is None or now - reading.stamp > limits.oldest:
            self._level = Level.UNKNOWN
            return BatteryVerdict(Level.UNKNOWN, False, 0.0, reading)
        margin = limits.margin if self._level in (Level.LOW, Level.CRITICAL) else 0.0
        if reading.charge < limits.critical + (margin if self._level is Level.CRITICAL else 0.0):
            self._level = Level.CRITICAL
        elif reading.charge < limits.low + margin or reading.temperature > limits.hottest:
            self._level = Level.LOW
        else:
            self._level = Level.NORMAL
        left = reading.charge / self._drain if self._drain > 1e-9 else 0.0
        return BatteryVerdict(self._level, reading.current > 0, left, reading)

"""The guards between a command and a joint: a gate that refuses bad commands, and the emergency stop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..data import SECOND, Cause, EmergencyStop, JointCommand
from ..spatial import Array

LATEST = 50_000_000  # ns: an older command answers a state that is long past
MISSING_AFTER = 100_000_000  # ns without a good command until commands count as missing
_WALL_CLOCK = 10**9 * SECOND  # ns: no simulation runs for 30 years
_SLACK = 1.5  # rad that a set-point may lie beyond a joint's range: it also contains torque feed-forward


@dataclass(slots=True)
class Refusals:
    """The number of refused commands, by reason; `missing` counts ticks without a good command."""

    late: int = 0
    second: int = 0  # for a tick that already had one, or without a tick while others name theirs
    not_finite: int = 0
    wrong_size: int = 0
    out_of_range: int = 0
    missing: int = 0

    @property
    def total(self) -> int:
        """All refused commands; ticks without a command are not counted."""
        return self.late + self.second + self.not_finite + self.wrong_size + self.out_of_range


def clock_problem(stamp: int, now: int, what: str) -> str:
    """Words for a stamp [ns] of the wall clock, where the time now is simulated; "" if it is none."""
    if stamp - now < _WALL_CLOCK:
        return ""
    return (
        f"{what} has the time of the wall clock, but the robot's time is simulated: start the node that "
        "sends it with `--ros-args -p use_sim_time:=true`"
    )


class CommandGate:
    """Passes good commands on to the servos, and keeps the last good one if none arrives."""

    def __init__(self, lower: Array, upper: Array) -> None:
        self._lower, self._upper = lower - _SLACK, upper + _SLACK
        self.refusals = Refusals()
        self.reason = ""  # why the last command was refused
        self.reset(np.zeros_like(lower))

    def reset(self, setpoints: Array) -> None:
        """Hold these positions (joints,) until the first command arrives; there is no limit to that wait."""
        self._setpoints = setpoints.copy()
        self._accepted: int | None = None
        self._answered: int | None = None  # the last tick that a command was for

    def accept(self, command: JointCommand, now: int) -> bool:
        """Whether the command is good; if so, it becomes the servos' set-points."""
        position = np.asarray(command.position, dtype=float)
        if impossible := self._impossible(position, command.stamp, now):
            kind, self.reason = impossible
            setattr(self.refusals, kind, getattr(self.refusals, kind) + 1)
        elif self._has_one(command, now):
            self.refusals.second += 1
            self.reason = "another publisher has already commanded this tick"
        else:
            self._setpoints = position.copy()
            self._accepted = now
            self._answered = command.stamp if command.answers else self._answered
            return True
        return False

    def impossible(self, command: JointCommand, now: int) -> str:
        """The reason why no servo can follow a command, or ""; nothing is counted."""
        _, reason = self._impossible(command.position, command.stamp, now) or ("", "")
        return reason

    def _impossible(self, position: Array, stamp: int, now: int) -> tuple[str, str] | None:
        """A field of `Refusals`, and the reason, if no servo can follow these positions now."""
        if position.shape != self._lower.shape:
            return (
                "wrong_size",
                f"a command needs {self._lower.size} positions, this one has {position.size}",
            )
        finite = np.isfinite(position)
        if not finite.all():
            return "not_finite", f"position {int(np.argmin(finite))} of the command is not a finite number"
        if now - stamp > LATEST:
            return "late", f"the command is {(now - stamp) / SECOND:.3f} s late"
        if stamp > now:
            ahead = f"the command is for a tick that is {(stamp - now) / SECOND:.3f} s ahead"
            return "late", clock_problem(stamp, now, "the command") or ahead
        if ((position < self._lower) | (position > self._upper)).any():
            return "out_of_range", "a position of the command is far outside the joint's range"
        return None

    def protect(self, setpoints: Array) -> None:
        """Follow these positions (joints,) instead of any command."""
        self._setpoints = setpoints.copy()

    def _has_one(self, command: JointCommand, now: int) -> bool:
        if self._answered is None:
            return False
        return command.stamp <= self._answered if command.answers else now - self._answered <= MISSING_AFTER

    def setpoints(self, now: int) -> Array:
        """The set-points (joints,) for the servos in the next tick."""
        if self._accepted is not None and now - self._accepted > MISSING_AFTER:
            self.refusals.missing += 1
        return self._setpoints

    def missing(self, now: int) -> bool:
        """Whether good commands have stopped coming."""
        return self._accepted is not None and now - self._accepted > MISSING_AFTER


class EmergencyStopLatch:
    """Collects requests to stop; a reset lifts the stop only when no request is left."""

    def __init__(self) -> None:
        self.status = EmergencyStop(active=False)
        self._asking: dict[str, tuple[Cause, str]] = {}

    def request(self, source: str, cause: Cause, reason: str, stamp: int) -> EmergencyStop | None:
        """Add a request to stop; returns the status to publish if it is new."""
        self._asking[source] = (cause, reason)
        if self.status.active:
            return None
        self.status = EmergencyStop(True, cause, source, reason, stamp)
        return self.status

    def withdraw(self, source: str) -> None:
        """Withdraw a request; the stop remains until it is reset."""
        self._asking.pop(source, None)

    def reset(self, stamp: int) -> tuple[bool, str]:
        """Lift the stop; returns (False, why) while a request remains."""
        if self._asking:
            source, (_, reason) = next(iter(self._asking.items()))
            return False, f"{source} still requests the stop: {reason}"
        was = self.status
        self.status = EmergencyStop(False, was.cause, was.source, was.reason, stamp)
        return True, ""

"""What stands between a command and a joint: refusing bad commands, and the latch of the emergency stop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..data import SECOND, Cause, EmergencyStop, JointCommand
from ..spatial import Array

LATEST = 50_000_000  # ns: an older command answers a state that is long gone
MISSING_AFTER = 100_000_000  # ns without a good command until commands count as missing
_SLACK = 1.5  # rad beyond a joint's range that a set-point may lie: it holds torque feed-forward as well


@dataclass(slots=True)
class Refusals:
    """How many commands were refused, by reason; `missing` counts ticks without any good one."""

    late: int = 0
    second: int = 0  # for a tick that had one already, or without a tick among others that name theirs
    not_finite: int = 0
    wrong_size: int = 0
    out_of_range: int = 0
    missing: int = 0

    @property
    def total(self) -> int:
        """All commands refused; ticks without one are not commands."""
        return self.late + self.second + self.not_finite + self.wrong_size + self.out_of_range


class CommandGate:
    """Lets good commands through to the servos and keeps the last good one where none comes."""

    def __init__(self, lower: Array, upper: Array) -> None:
        self._lower, self._upper = lower - _SLACK, upper + _SLACK
        self.refusals = Refusals()
        self.reason = ""  # why the last command was refused
        self.reset(np.zeros_like(lower))

    def reset(self, setpoints: Array) -> None:
        """Hold these positions (29,) until the first command comes; it may take its time."""
        self._setpoints = setpoints.copy()
        self._accepted: int | None = None
        self._answered: int | None = None  # the last tick that a command was for

    def accept(self, command: JointCommand, now: int) -> bool:
        """Whether the command is good; if so it becomes the servos' set-points."""
        position = np.asarray(command.position, dtype=float)
        if position.shape != self._lower.shape:
            self.refusals.wrong_size += 1
            self.reason = f"a command needs {self._lower.size} positions, this one has {position.size}"
        elif not np.isfinite(position).all():
            self.refusals.not_finite += 1
            self.reason = (
                f"position {int(np.argmin(np.isfinite(position)))} of the command is not a finite number"
            )
        elif now - command.stamp > LATEST:
            self.refusals.late += 1
            self.reason = f"the command is {(now - command.stamp) / SECOND:.3f} s late"
        elif command.stamp > now:
            self.refusals.late += 1
            self.reason = f"the command is for a tick that is {(command.stamp - now) / SECOND:.3f} s ahead"
        elif ((position < self._lower) | (position > self._upper)).any():
            self.refusals.out_of_range += 1
            self.reason = "a position of the command is far outside of the joint's range"
        elif self._has_one(command, now):
            self.refusals.second += 1
            self.reason = "another publisher's command has this tick already"
        else:
            self._setpoints = position.copy()
            self._accepted = now
            self._answered = command.stamp if command.answers else self._answered
            return True
        return False

    def protect(self, setpoints: Array) -> None:
        """Follow these positions (29,) instead, whoever commands what."""
        self._setpoints = setpoints.copy()

    def _has_one(self, command: JointCommand, now: int) -> bool:
        if self._answered is None:
            return False
        return command.stamp <= self._answered if command.answers else now - self._answered <= MISSING_AFTER

    def setpoints(self, now: int) -> Array:
        """What the servos shall follow in the coming tick (29,)."""
        if self._accepted is not None and now - self._accepted > MISSING_AFTER:
            self.refusals.missing += 1
        return self._setpoints

    def missing(self, now: int) -> bool:
        """Whether good commands have stopped coming."""
        return self._accepted is not None and now - self._accepted > MISSING_AFTER


class EmergencyStopLatch:
    """Collects requests to stop; a reset lifts the stop only when nobody asks for it any more."""

    def __init__(self) -> None:
        self.status = EmergencyStop(active=False)
        self._asking: dict[str, tuple[Cause, str]] = {}

    def request(self, source: str, cause: Cause, reason: str, stamp: int) -> EmergencyStop | None:
        """Somebody asks for a stop; gives the status to publish if it is new."""
        self._asking[source] = (cause, reason)
        if self.status.active:
            return None
        self.status = EmergencyStop(True, cause, source, reason, stamp)
        return self.status

    def withdraw(self, source: str) -> None:
        """Somebody no longer asks for a stop; the stop stays until it is reset."""
        self._asking.pop(source, None)

    def reset(self, stamp: int) -> tuple[bool, str]:
        """Lift the stop; (False, why) while somebody still asks for it."""
        if self._asking:
            source, (_, reason) = next(iter(self._asking.items()))
            return False, f"{source} still asks for the stop: {reason}"
        was = self.status
        self.status = EmergencyStop(False, was.cause, was.source, was.reason, stamp)
        return True, ""

"""Lengths of time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

from rclpy.constants import S_TO_NS
from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

if TYPE_CHECKING:
    import builtin_interfaces.msg


class DurationType(Protocol):
    """The client library's side of a duration."""

    nanoseconds: int


class Duration:
    """A signed length of time with nanosecond resolution.

    :param seconds: may have a fraction.
    :param nanoseconds: a fraction is cut off; the two are added.
    :raises OverflowError: beyond 64 bits of nanoseconds.
    """

    def __init__(self, *, seconds: int | float = 0, nanoseconds: int = 0) -> None:
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -(2**63) <= total < 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self._duration_handle = _rclpy.rcl_duration_t(total)

    @property
    def nanoseconds(self) -> int:
        """All of it in nanoseconds."""
        return self._duration_handle.nanoseconds

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self.nanoseconds})"

    def __str__(self) -> str:
        return "Infinite" if self == Infinite else f"{self.nanoseconds} nanoseconds"

    def __eq__(self, other: object) -> bool:
        return self.nanoseconds == other.nanoseconds if isinstance(other, Duration) else NotImplemented

    __hash__ = None  # type: ignore[assignment]  # as upstream: defines equality only

    def __lt__(self, other: object) -> bool:
        return self.nanoseconds < other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __le__(self, other: object) -> bool:
        return self.nanoseconds <= other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __gt__(self, other: object) -> bool:
        return self.nanoseconds > other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __ge__(self, other: object) -> bool:
        return self.nanoseconds >= other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __add__(self, other: Duration) -> Duration:
        if not isinstance(other, Duration):
            return NotImplemented
        distro.uses("Duration")
        return Duration(nanoseconds=self.nanoseconds + other.nanoseconds)

    def __sub__(self, other: Duration) -> Duration:
        if not isinstance(other, Duration):
            return NotImplemented
        distro.uses("Duration")
        return Duration(nanoseconds=self.nanoseconds - other.nanoseconds)

    def __mul__(self, factor: float) -> Duration:
        if not isinstance(factor, int | float):
            return NotImplemented
        distro.uses("Duration")
        if factor == math.inf:
            return Duration(nanoseconds=Infinite.nanoseconds)
        if not math.isfinite(factor):
            raise ValueError("Can't multiply duration with nan")
        return Duration(nanoseconds=int(self.nanoseconds * factor))

    def to_msg(self) -> builtin_interfaces.msg.Duration:
        """Convert to builtin_interfaces/msg/Duration."""
        from builtin_interfaces.msg import (
            Duration as DurationMessage,  # generated: not needed to import rclpy
        )

        seconds, nanoseconds = divmod(self.nanoseconds, S_TO_NS)
        return DurationMessage(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: builtin_interfaces.msg.Duration) -> Duration:
        """Convert from builtin_interfaces/msg/Duration; TypeError for anything else."""
        from builtin_interfaces.msg import (
            Duration as DurationMessage,  # generated: not needed to import rclpy
        )

        if not isinstance(msg, DurationMessage):
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)

    def get_c_duration(self) -> _rclpy.rcl_duration_t:
        """Return the client library's side."""
        return self._duration_handle


Infinite = Duration(nanoseconds=_rclpy.RMW_DURATION_INFINITE)

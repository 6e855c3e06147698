"""Points in time."""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Protocol, overload

from rclpy.constants import S_TO_NS
from rclpy.duration import Duration
from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from .clock_type import ClockType

if TYPE_CHECKING:
    import datetime

    import builtin_interfaces.msg


class TimeHandle(Protocol):
    """The client library's side of a time."""

    nanoseconds: int
    clock_type: ClockType


class Time:
    """A point on one kind of clock, not before its epoch.

    Times of different clocks do not compare (TypeError).

    :param seconds: may have a fraction.
    :param nanoseconds: a fraction is cut off; the two are added.
    :raises ValueError: if one of them is negative.
    :raises OverflowError: beyond 63 bits of nanoseconds.
    """

    def __init__(
        self,
        *,
        seconds: int | float = 0,
        nanoseconds: int = 0,
        clock_type: ClockType = ClockType.SYSTEM_TIME,
    ) -> None:
        if not isinstance(clock_type, (ClockType, _rclpy.ClockType)):
            raise TypeError("Clock type must be a ClockType enum")
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total >= 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._time_handle = _rclpy.rcl_time_point_t(total, clock_type)

    @classmethod
    def _of_handle(cls, handle: _rclpy.rcl_time_point_t) -> Time:
        """Make a time of what the client library's side of a clock has read; spares the checks."""
        time = cls.__new__(cls)
        time._time_handle = handle
        return time

    @property
    def nanoseconds(self) -> int:
        """Nanoseconds since the clock's epoch."""
        return self._time_handle.nanoseconds

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Return whole seconds and the nanoseconds on top."""
        return divmod(self.nanoseconds, S_TO_NS)

    @property
    def clock_type(self) -> _rclpy.ClockType:
        """The kind of clock that this is a time of."""
        return self._time_handle.clock_type

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self.nanoseconds}, clock_type={self.clock_type.name})"

    def __add__(self, other: Duration) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return self._later(other.nanoseconds)
        except OverflowError as error:
            raise OverflowError("Addition leads to overflow in C storage.") from error

    __radd__ = __add__

    @overload
    def __sub__(self, other: Time) -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> Time: ...
    def __sub__(self, other: Time | Duration) -> Time | Duration:
        if isinstance(other, Time):
            if self.clock_type != other.clock_type:
                raise TypeError("Can't subtract times with different clock types")
            return Duration(nanoseconds=self.nanoseconds - other.nanoseconds)
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return self._later(-other.nanoseconds)
        except ValueError as error:
            raise ValueError("Subtraction leads to negative time.") from error

    def __eq__(self, other: object) -> bool:
        return self._compare(other, operator.eq)

    __hash__ = None  # type: ignore[assignment]  # as upstream: defines equality only

    def __ne__(self, other: object) -> bool:
        return self._compare(other, operator.ne)

    def __lt__(self, other: object) -> bool:
        return self._compare(other, operator.lt)

    def __le__(self, other: object) -> bool:
        return self._compare(other, operator.le)

    def __gt__(self, other: object) -> bool:
        return self._compare(other, operator.gt)

    def __ge__(self, other: object) -> bool:
        return self._compare(other, operator.ge)

    def to_msg(self) -> builtin_interfaces.msg.Time:
        """Convert to builtin_interfaces/msg/Time."""
        seconds, nanoseconds = self.seconds_nanoseconds()
        return _message_class()(sec=seconds, nanosec=nanoseconds)

    def to_datetime(self) -> datetime.datetime:
        """Convert to local time without a zone; TypeError for steady time, which is no time of day."""
        import datetime  # late: few programs need it

        distro.uses("to_datetime")
        if self.clock_type == _rclpy.ClockType.STEADY_TIME:
            raise TypeError("Steady time has no date: it counts from an arbitrary point")
        return datetime.datetime.fromtimestamp(self.nanoseconds / S_TO_NS)

    @classmethod
    def from_msg(cls, msg: builtin_interfaces.msg.Time, clock_type: ClockType = ClockType.ROS_TIME) -> Time:
        """Convert from builtin_interfaces/msg/Time, which does not name its clock; TypeError for others."""
        if not isinstance(msg, _message_class()):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)

    def _later(self, nanoseconds: int) -> Time:
        clock_type = ClockType(self.clock_type)
        return Time(nanoseconds=self.nanoseconds + nanoseconds, clock_type=clock_type)

    def _compare(self, other: object, relation: Callable[[int, int], bool]) -> bool:
        if not isinstance(other, Time):
            return NotImplemented  # type: ignore[no-any-return]  # what comparisons may give
        if self.clock_type != other.clock_type:
            raise TypeError("Can't compare times with different clock types")
        return relation(self.nanoseconds, other.nanoseconds)


@cache
def _message_class() -> type[builtin_interfaces.msg.Time]:
    from builtin_interfaces.msg import Time as TimeMessage  # late: not every program needs messages

    return TimeMessage

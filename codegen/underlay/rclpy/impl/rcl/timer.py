"""Timers: they keep phase, do not burst, and follow the jumps of their clock."""

from __future__ import annotations

from rmw_local.ready import ReadySource

from .clock import Clock, ClockType
from .context import Context
from .destroyable import Destroyable
from .errors import CONTEXT_NOT_VALID, RCLError


def _as_bool(value: object) -> bool:
    """A flag as C++ sees it; TypeError for values that Python only counts as true or false."""
    if value is not None and not hasattr(type(value), "__bool__"):
        raise TypeError(f"Timer(): a flag is a bool, not {type(value).__name__}")
    return bool(value)


class Timer(Destroyable, ReadySource):
    """Ready when its clock shows `next call`; every time and period in ns."""

    def __init__(self, clock: Clock, context: Context, period_ns: int, autostart: bool) -> None:
        Destroyable.__init__(self)
        ReadySource.__init__(self)
        if period_ns < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        if not context.valid:
            raise RCLError(f"failed to create timer: {CONTEXT_NOT_VALID}")
        self._clock = clock
        self._period = int(period_ns)
        self._last_call = clock.now_ns()
        self._next_call = self._last_call + self._period
        self._credit = 0  # what was left of the period when the source of time changed
        self._canceled = not _as_bool(autostart)
        if clock.type is ClockType.ROS_TIME:
            clock.attach_timer(self)

    def is_ready(self) -> bool:
        """Whether the next call is due."""
        return not self._canceled and not self._destroyed and self._clock.now_ns() >= self._next_call

    def wake_at(self) -> int | None:
        """The time of the next call [ns, steady]; None if it is stopped."""
        if self._canceled or self._destroyed:
            return None
        return self._clock.steady_time_of(self._next_call)

    def is_timer_ready(self) -> bool:
        """Whether it may be called."""
        return self.is_ready()

    def call_timer(self) -> None:
        """Count as called now: the next call is one period later, or the first such point to come."""
        if self._canceled:
            raise RCLError("failed to call timer: timer is canceled")
        now = self._clock.now_ns()
        self._last_call = now
        following = self._next_call + self._period
        if following <= now:
            missed = (now - following) // self._period + 1 if self._period else 0
            following = following + missed * self._period if self._period else now
        self._next_call = following

    def cancel_timer(self) -> None:
        """Stop it until `reset_timer`."""
        self._canceled = True

    def is_timer_canceled(self) -> bool:
        """Whether it is stopped."""
        return self._canceled

    def reset_timer(self) -> None:
        """Start a whole period from now on."""
        self._next_call = self._clock.now_ns() + self._period
        self._canceled = False
        self.notify()

    def get_timer_period(self) -> int:
        """The period."""
        return self._period

    def change_timer_period(self, period_ns: int) -> None:
        """Use another period after the next call."""
        self._period = period_ns

    def time_since_last_call(self) -> int:
        """The time since it was called or made."""
        return self._clock.now_ns() - self._last_call

    def time_until_next_call(self) -> int | None:
        """The time until it is ready (negative: overdue); None if it is stopped."""
        return None if self._canceled else self._next_call - self._clock.now_ns()

    def before_change(self) -> None:
        """Keep what is left of the period when the source of time changes (time 0 is no time yet)."""
        if (now := self._clock.now_ns()) != 0:
            self._credit = self._next_call - now

    def after_change(self) -> None:
        """Apply what was kept."""
        now = self._clock.now_ns()
        if now != 0 and (credit := self._credit):
            self._credit = 0
            self._next_call = now - credit + self._period
            self._last_call = now - credit
        self.notify()

    def after_jump(self) -> None:
        """After a jump backwards over the last call, start a new period; else see whether it is due."""
        now = self._clock.now_ns()
        if now >= self._next_call:
            self.notify()
        elif now < self._last_call:
            self._next_call = now + self._period
            self._last_call = now

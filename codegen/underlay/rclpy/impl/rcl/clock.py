"""Clocks of system, steady and ROS time, the callbacks around jumps of ROS time, and timers."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable
from typing import Protocol, SupportsInt, TypedDict

from rmw_local import timing
from rmw_local.ready import ReadySource

from rclpy.impl import distro

from .context import Context
from .handle import CONTEXT_NOT_VALID, Destroyable, RCLError, TimerCancelledError, Unpicklable, as_bool
from .structs import ExtensionEnum

_INT64 = range(-(2**63), 2**63)


class ClockType(ExtensionEnum):
    """The kind of time of a clock."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


class ClockChange(ExtensionEnum):
    """The kind of a time jump."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class rcl_time_point_t(Unpicklable):
    """A time [ns] on a kind of clock."""

    __slots__ = ("clock_type", "nanoseconds")

    def __init__(self, nanoseconds: int, clock_type: SupportsInt) -> None:
        if nanoseconds not in _INT64:
            raise TypeError(f"rcl_time_point_t(): {nanoseconds!r} is no 64-bit integer")
        self.nanoseconds = nanoseconds
        self.clock_type = clock_type if type(clock_type) is ClockType else ClockType(int(clock_type))


class rcl_duration_t(Unpicklable):
    """A length of time [ns]."""

    __slots__ = ("nanoseconds",)

    def __init__(self, nanoseconds: int) -> None:
        if nanoseconds not in _INT64:
            raise TypeError(f"rcl_duration_t(): {nanoseconds!r} is no 64-bit integer")
        self.nanoseconds = nanoseconds


class JumpDictionary(TypedDict):
    """The argument of a post-jump callback; `delta` in ns."""

    clock_change: ClockChange
    delta: int


class JumpHandle(Protocol):
    """The upper layer's `rclpy.clock.JumpHandle`: the callbacks of one registration."""

    def _pre_callback(self) -> object: ...

    def _post_callback(self, jump: JumpDictionary) -> object: ...


class _Registration:
    """A jump handle with its thresholds [ns]; 0 switches one off."""

    __slots__ = ("handle", "min_backward", "min_forward", "on_clock_change")

    def __init__(self, handle: JumpHandle, on_clock_change: bool, forward: int, backward: int) -> None:
        self.handle = handle
        self.on_clock_change = on_clock_change
        self.min_forward = forward
        self.min_backward = backward

    def exceeded_by(self, change: ClockChange, delta: int) -> bool:
        if change in (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED):
            return self.on_clock_change
        forward = self.min_forward and delta >= self.min_forward
        return bool(forward or (self.min_backward and delta <= self.min_backward))


class Clock(Destroyable):
    """Reads one kind of time. A ROS clock shows system time until an override is switched on."""

    def __init__(self, clock_type: int) -> None:
        super().__init__()
        if clock_type not in (ClockType.ROS_TIME, ClockType.SYSTEM_TIME, ClockType.STEADY_TIME):
            raise RCLError("failed to initialize clock: error not set")
        self.type = ClockType(clock_type)
        self._is_steady = self.type is ClockType.STEADY_TIME
        self._override: int | None = None  # [ns] while the override is on
        self._override_value = 0
        self._registrations: tuple[_Registration, ...] = ()
        self._timers: tuple[weakref.ref[Timer], ...] = ()  # a WeakSet takes longer to go through
        self._changing = threading.RLock()  # one jump at a time; user callbacks run inside, hence reentrant

    def now_ns(self) -> int:
        """The time [ns]."""
        if self._is_steady:
            return timing.monotonic_ns()
        override = self._override
        return timing.time_ns() if override is None else override

    def steady_time_of(self, time_ns: int) -> int | None:
        """The steady time [ns] at which this clock will show `time_ns`; None if only messages move it."""
        if self._is_steady:
            return time_ns
        if self._override is not None:
            return None
        return timing.monotonic_ns() + time_ns - timing.time_ns()

    def get_now(self) -> rcl_time_point_t:
        """Read it."""
        return rcl_time_point_t(self.now_ns(), self.type)

    def get_ros_time_override_is_enabled(self) -> bool:
        """Whether a ROS clock shows the override."""
        self._must_be_ros("failed to get ROS time override status", "query override state")
        return self._override is not None

    def set_ros_time_override_is_enabled(self, enabled: bool) -> None:
        """Switch between system time and the override; a clock change if it was not so before."""
        self._must_be_ros("failed to set ROS time override", "enable override")
        if enabled == (self._override is not None):
            return
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
        self._jump(change, 0, self._override_value if enabled else None)

    def set_ros_time_override(self, time_point: rcl_time_point_t) -> None:
        """Set what the override shows; a jump if it is on."""
        self._must_be_ros("failed to set ROS time override", "set time override")
        value = time_point.nanoseconds
        if self._override is None:
            self._override_value = value
        else:
            self._jump(ClockChange.ROS_TIME_NO_CHANGE, value - self._override, value)

    def add_clock_callback(
        self, pyjump_handle: JumpHandle, on_clock_change: bool, min_forward: int, min_backward: int
    ) -> None:
        """Call the handle's callbacks around jumps beyond these thresholds [ns] (0: off)."""
        registration = _Registration(pyjump_handle, on_clock_change, min_forward, min_backward)
        with self._changing:
            self._registrations = (*self._registrations, registration)

    def remove_clock_callback(self, pyjump_handle: JumpHandle) -> None:
        """Take back `add_clock_callback`."""
        with self._changing:
            kept = tuple(known for known in self._registrations if known.handle is not pyjump_handle)
            if len(kept) == len(self._registrations):
                raise RCLError("failed to remove time jump callback: jump callback was not found")
            self._registrations = kept

    def attach_timer(self, timer: Timer) -> None:
        """Tell this timer about jumps as long as it lives."""
        with self._changing:
            self._timers = (*(known for known in self._timers if known() is not None), weakref.ref(timer))

    def _must_be_ros(self, what: str, cannot: str) -> None:
        if self.type is not ClockType.ROS_TIME:
            raise RCLError(f"{what}: Clock is not of type RCL_ROS_TIME, cannot {cannot}.")

    def _jump(self, change: ClockChange, delta: int, override: int | None) -> None:
        with self._changing:
            told = [known for known in self._registrations if known.exceeded_by(change, delta)]
            timers = [timer for known in self._timers if (timer := known()) is not None]
            if change is not ClockChange.ROS_TIME_NO_CHANGE:
                for timer in timers:
                    timer.before_change()
            for registration in told:
                if callable(registration.handle._pre_callback):
                    registration.handle._pre_callback()
            if override is not None:
                self._override_value = override
            self._override = override
            for timer in timers:
                if change is ClockChange.ROS_TIME_NO_CHANGE:
                    timer.after_jump()
                else:
                    timer.after_change()
            for registration in told:
                if callable(registration.handle._post_callback):
                    registration.handle._post_callback({"clock_change": change, "delta": delta})


class ClockEvent:
    """Something to wait for until it is set or a clock shows some time."""

    def __init__(self) -> None:
        self._event = timing.Event()

    def set(self) -> None:
        """Set it and wake all waiting threads."""
        self._event.set()

    def clear(self) -> None:
        """Unset it."""
        self._event.clear()

    def is_set(self) -> bool:
        """Whether it is set."""
        return self._event.is_set()

    def wait_until_steady(self, clock: Clock, until: rcl_time_point_t) -> None:
        """Wait until it is set or a steady clock shows `until`."""
        self._wait(clock, until)

    def wait_until_system(self, clock: Clock, until: rcl_time_point_t) -> None:
        """Wait until it is set or a system clock shows `until`."""
        self._wait(clock, until)

    def wait_until_ros(self, clock: Clock, until: rcl_time_point_t) -> None:
        """Wait until it is set or a ROS clock shows `until`; if that follows /clock, until it is set."""
        clock.get_ros_time_override_is_enabled()
        self._wait(clock, until)

    def _wait(self, clock: Clock, until: rcl_time_point_t) -> None:
        if clock.type != until.clock_type:
            raise RCLError(
                "failed to subtract times: Cannot difference between time points with clocks types."
            )
        self._event.wait_until(clock.steady_time_of(until.nanoseconds))


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
        self._canceled = not as_bool(autostart, "autostart")
        self._on_reset: Callable[[int], object] | None = None
        self._resets = 0  # those that no callback has been told of
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

    def call_timer_with_info(self) -> dict[str, int]:
        """Do what `call_timer` does; returns when it was due and when it was called."""
        distro.uses("call_timer_with_info")
        expected, actual = self.call_and_time()
        return {"expected_call_time": expected, "actual_call_time": actual}

    def call_and_time(self) -> tuple[int, int]:
        """Do what `call_timer` does; returns when it was due and when it was called."""
        if self._canceled:
            raise TimerCancelledError("failed to call timer: timer is canceled")
        expected = self._next_call
        self.call_timer()
        return expected, self._last_call

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
        if self._on_reset is None:
            self._resets += 1
        else:
            self._on_reset(1)

    def set_on_reset_callback(self, callback: Callable[[int], object]) -> None:
        """Call back with the number of resets, on the thread that resets; at once with those before."""
        distro.uses("on_new_callbacks")
        if not callable(callback):
            raise TypeError(f"expected a callback that takes a number, got {callback!r}")
        self._on_reset = callback
        resets, self._resets = self._resets, 0
        if resets:
            callback(resets)

    def clear_on_reset_callback(self) -> None:
        """End it."""
        self._on_reset = None

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

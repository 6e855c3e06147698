"""Clocks and timers that are awaited, on wall time or on that of /clock."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import rclpy.timer
from rclpy.clock import Clock, ClockChange, JumpHandle, JumpThreshold, ROSClock, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.exceptions import InvalidHandle
from rclpy.time import Time

from rclpy_asyncio.driver import Driver, remaining, takes
from rclpy_asyncio.readiness import Bell, ring_later


class TimeSourceChangedError(RuntimeError):
    """The clock was switched between wall time and simulated time during a sleep."""


@dataclass(frozen=True, kw_only=True)
class _TimerInfo:
    """The times of one call of a timer, on its clock."""

    expected_call_time: Time
    actual_call_time: Time


@dataclass(eq=False)
class _Sleeper:
    until: Time
    done: asyncio.Future[None]
    loop: asyncio.AbstractEventLoop


class AsyncClock:
    """A clock with a `sleep` to await; that of a node follows ROS time.

    :param clock: what tells the time; None for a ROS clock of its own.
    """

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock: Any = ROSClock() if clock is None else clock
        self._jumps: JumpHandle | None = None
        self._sleepers: dict[_Sleeper, None] = {}  # a set with order
        self._bells: set[Bell] = set()
        self._is_destroyed = False

    @property
    def clock_type(self) -> ClockType:
        """The kind of time."""
        kind: ClockType = self._clock.clock_type
        return kind

    @property
    def handle(self) -> Any:
        """The client library's side."""
        return self._clock.handle

    @property
    def ros_time_is_active(self) -> bool:
        """Whether it shows simulated time."""
        return isinstance(self._clock, ROSClock) and self._clock.ros_time_is_active

    def now(self) -> Time:
        """Read it."""
        now: Time = self._clock.now()
        return now

    def set_ros_time_override(self, time: Time) -> None:
        """Tell it the time that it shows while simulated time is on."""
        self._clock.set_ros_time_override(time)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], None] | None = None,
        post_callback: Callable[[TimeJump], None] | None = None,
    ) -> JumpHandle:
        """Have callbacks called around jumps, on the thread that makes the jump."""
        handle: JumpHandle = self._clock.create_jump_callback(
            threshold, pre_callback=pre_callback, post_callback=post_callback
        )
        return handle

    async def sleep(self, duration_sec: float) -> None:
        """Sleep for a time [s] of this clock; zero or less: one turn of the loop.

        Simulated time passes by jumps: a jump back does not move the end.

        :raises TimeSourceChangedError: if simulated time is switched on or off meanwhile.
        :raises RuntimeError: if the clock is destroyed; CancelledError if that happens meanwhile.
        """
        if self._is_destroyed:
            raise RuntimeError("Cannot sleep on a destroyed clock")
        if duration_sec <= 0:
            await asyncio.sleep(0)
            return
        self._hear_jumps()
        loop = asyncio.get_running_loop()
        sleeper = _Sleeper(
            until=self.now() + Duration(nanoseconds=int(duration_sec * 1e9)),
            done=loop.create_future(),
            loop=loop,
        )
        alarm = None
        if not self.ros_time_is_active:
            alarm = loop.call_later(duration_sec, _settle, sleeper.done, None)
        self._sleepers[sleeper] = None
        try:
            await sleeper.done
        finally:
            self._sleepers.pop(sleeper, None)
            if alarm is not None:
                alarm.cancel()

    def destroy(self) -> None:
        """Cancel all sleeps; later ones fail."""
        self._is_destroyed = True
        if self._jumps is not None:
            self._jumps.unregister()
            self._jumps = None
        for sleeper in list(self._sleepers):
            sleeper.done.cancel()

    def ring_at_jumps(self, bell: Bell) -> None:
        """Ring a bell whenever the time jumps, until `ring_no_more`."""
        self._hear_jumps()
        self._bells.add(bell)

    def ring_no_more(self, bell: Bell) -> None:
        """Take back `ring_at_jumps`."""
        self._bells.discard(bell)

    def _hear_jumps(self) -> None:
        if self._jumps is None and not self._is_destroyed and isinstance(self._clock, ROSClock):
            nanosecond = Duration(nanoseconds=1)
            threshold = JumpThreshold(min_forward=nanosecond, min_backward=Duration(nanoseconds=-1))
            self._jumps = self._clock.create_jump_callback(threshold, post_callback=self._on_jump)

    def _on_jump(self, jump: TimeJump) -> None:
        """Wake those whose time has come; on the thread that makes the jump."""
        switched = jump.clock_change in (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED)
        now = self.now()
        for sleeper in list(self._sleepers):
            if switched:
                error = TimeSourceChangedError("simulated time was switched on or off during a sleep")
                ring_later(sleeper.loop, partial(_settle, sleeper.done, error))
            elif self.ros_time_is_active and now >= sleeper.until:
                ring_later(sleeper.loop, partial(_settle, sleeper.done, None))
        for bell in list(self._bells):
            bell.ring()


def _settle(done: asyncio.Future[None], error: Exception | None) -> None:
    if done.done():
        return
    if error is None:
        done.set_result(None)
    else:
        done.set_exception(error)


class AsyncTimer:
    """Calls back every period of its node's clock, made by `AsyncNode.create_timer`; times in ns.

    Calls never overlap, and a period that passes during one is left out.
    """

    def __init__(
        self,
        driver: Driver,
        timer: rclpy.timer.Timer,
        clock: AsyncClock,
        callback: Callable[..., Any],
        on_destroy: Callable[[AsyncTimer], None],
    ) -> None:
        self._driver = driver
        self._timer = timer
        self._clock = clock
        self._bell: Bell | None = None
        self._on_destroy = on_destroy
        self._is_destroyed = False
        self.callback = callback
        driver.serve(timer, self._serve)

    @property
    def callback(self) -> Callable[..., Any]:
        """The callback: a function or coroutine function with no argument, or one for a TimerInfo."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        if not takes(value, 0) and not takes(value, 1):
            raise RuntimeError("Timer callback must accept zero arguments or one argument (TimerInfo)")
        self._callback = value
        self._wants_info = not takes(value, 0)

    @property
    def clock(self) -> AsyncClock:
        """The clock of the period."""
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        """The period; a new one counts from the next call on."""
        return self._timer.timer_period_ns

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self._timer.timer_period_ns = value
        self._ring()

    def is_ready(self) -> bool:
        """Return whether a call is due."""
        return self._timer.is_ready()

    def is_canceled(self) -> bool:
        """Return whether it is stopped."""
        return self._timer.is_canceled()

    def cancel(self) -> None:
        """Stop it until `reset`."""
        self._timer.cancel()
        self._ring()

    def reset(self) -> None:
        """Start a whole period now."""
        self._timer.reset()
        self._ring()

    def time_since_last_call(self) -> int:
        """Return how long ago it was called or made."""
        return self._timer.time_since_last_call()

    def time_until_next_call(self) -> int | None:
        """Return how long until it is due (negative: overdue); None if it is stopped."""
        return self._timer.time_until_next_call()

    def destroy(self) -> None:
        """Destroy it, and cancel its callback if that runs."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._driver.forget(self._timer)
            self._on_destroy(self)
            self._driver.node.destroy_timer(self._timer)

    def _ring(self) -> None:
        if self._bell is not None:
            self._bell.ring()

    def _call(self, due: int) -> Any:
        if not self._wants_info:
            return self._callback()
        now = self._clock.now()
        make: Any = vars(rclpy.timer).get("TimerInfo")  # real rclpy's, since Kilted
        if make is not None:
            info = make(
                expected_call_time=max(now.nanoseconds + due, 0),
                actual_call_time=now.nanoseconds,
                clock_type=self._clock.clock_type,
            )
        else:
            info = _TimerInfo(expected_call_time=now + Duration(nanoseconds=due), actual_call_time=now)
        return self._callback(info)

    async def _serve(self) -> None:
        self._bell = Bell(self._driver.loop)
        await run_timer(self._timer, self._clock, self._bell, self._call)


async def run_timer(
    timer: rclpy.timer.Timer, clock: AsyncClock, bell: Bell, call: Callable[[int], Any]
) -> None:
    """Call whenever the timer is due, until the task is cancelled; the bell rings when it changes.

    :param call: is told the time until it was due [ns], which is zero or negative.
    """
    loop = asyncio.get_running_loop()
    clock.ring_at_jumps(bell)
    try:
        while True:
            bell.clear()
            due = None if timer.is_canceled() else timer.time_until_next_call()
            if due is not None and due <= 0 and timer.is_ready():
                # The next period begins before the call, which may cancel the timer.
                handle: Any = timer.handle
                handle.call_timer()
                later = remaining(call(due))
                await (asyncio.sleep(0) if later is None else later)
                continue
            alarm = None
            if due is not None and not clock.ros_time_is_active:
                alarm = loop.call_later(max(due, 0) / 1e9, bell.ring)
            try:
                await bell.wait()
            finally:
                if alarm is not None:
                    alarm.cancel()
    except InvalidHandle:
        if not _is_destroyed(timer):
            raise  # of something that the callback has used
    finally:
        clock.ring_no_more(bell)


def _is_destroyed(timer: rclpy.timer.Timer) -> bool:
    try:
        timer.is_canceled()
    except InvalidHandle:
        return True
    return False

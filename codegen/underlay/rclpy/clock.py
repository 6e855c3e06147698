"""Clocks, and what happens when their time jumps."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypedDict

from rclpy.impl import distro
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport

from .clock_type import ClockType as ClockType  # noqa: PLC0414 - users import it from here
from .context import Context
from .destroyable import DestroyableType
from .duration import Duration
from .exceptions import NotInitializedException
from .time import Time, TimeHandle
from .utilities import get_default_context

if TYPE_CHECKING:
    from typing import Self
else:
    __getattr__ = reexport(__name__)


class ClockChange(IntEnum):
    """Whether a jump came with a change of the source of time."""

    ROS_TIME_NO_CHANGE = _rclpy.ClockChange.ROS_TIME_NO_CHANGE
    ROS_TIME_ACTIVATED = _rclpy.ClockChange.ROS_TIME_ACTIVATED
    ROS_TIME_DEACTIVATED = _rclpy.ClockChange.ROS_TIME_DEACTIVATED
    SYSTEM_TIME_NO_CHANGE = _rclpy.ClockChange.SYSTEM_TIME_NO_CHANGE


class JumpThreshold:
    """The jumps that matter.

    :param min_forward: jumps ahead by at least this positive duration; None: none of them.
    :param min_backward: jumps back by at least this negative duration; None: none of them.
    :param on_clock_change: jumps because ROS time was switched on or off.
    :raises ValueError: for a sign that is wrong, a zero, or if nothing matters.
    """

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change


class TimeJump:
    """The argument of a jump callback: the change of source, and the distance in time."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        if not isinstance(clock_change, (ClockChange, _rclpy.ClockChange)):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")
        self._clock_change = clock_change
        self._delta = delta

    @property
    def clock_change(self) -> ClockChange:
        """The change of the source of time."""
        return self._clock_change

    @property
    def delta(self) -> Duration:
        """The distance in time; negative: backwards."""
        return self._delta


class TimeJumpDictionary(TypedDict):
    """A time jump, as the client library reports it; `delta` in ns."""

    clock_change: ClockChange
    delta: int


JumpHandlePreCallbackType: TypeAlias = Callable[[], None]


class JumpHandle:
    """A registration of jump callbacks; it ends with `unregister` or the `with` block.

    :param clock: the clock that may jump.
    :param threshold: which jumps matter.
    :param pre_callback: called before the time changes.
    :param post_callback: called afterwards with a TimeJumpDictionary.
    :raises ValueError: if neither is given, or one is not callable.
    """

    def __init__(
        self,
        *,
        clock: _BaseClock,
        threshold: JumpThreshold,
        pre_callback: JumpHandlePreCallbackType | None,
        post_callback: Callable[[TimeJumpDictionary], None] | None,
    ) -> None:
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        if pre_callback is not None and not callable(pre_callback):
            raise ValueError("pre_callback must be callable if given")
        if post_callback is not None and not callable(post_callback):
            raise ValueError("post_callback must be callable if given")
        self._clock: _BaseClock | None = clock
        self._pre_callback = pre_callback
        self._post_callback = post_callback
        forward = threshold.min_forward.nanoseconds if threshold.min_forward else 0
        backward = threshold.min_backward.nanoseconds if threshold.min_backward else 0
        with clock.handle:
            clock.handle.add_clock_callback(self, threshold.on_clock_change, forward, backward)

    def unregister(self) -> None:
        """Have the callbacks called no more."""
        if self._clock is not None:
            with self._clock.handle:
                self._clock.handle.remove_clock_callback(self)
            self._clock = None

    def __enter__(self) -> JumpHandle:
        return self

    def __exit__(
        self, t: type[BaseException] | None, v: BaseException | None, tb: TracebackType | None
    ) -> None:
        self.unregister()


class ClockHandle(DestroyableType, Protocol):
    """The client library's side of a clock."""

    def get_now(self) -> TimeHandle:
        """Read it."""
        ...

    def get_ros_time_override_is_enabled(self) -> bool:
        """Whether a ROS clock shows the time that was set."""
        ...

    def set_ros_time_override_is_enabled(self, enabled: bool) -> None:
        """Let a ROS clock show the time that was set, or system time."""
        ...

    def set_ros_time_override(self, time_point: TimeHandle) -> None:
        """Tell a ROS clock the time."""
        ...

    def add_clock_callback(
        self, pyjump_handle: JumpHandle, on_clock_change: bool, min_forward: int, min_backward: int
    ) -> None:
        """Register jump callbacks."""
        ...

    def remove_clock_callback(self, pyjump_handle: JumpHandle) -> None:
        """Take back `add_clock_callback`."""
        ...


class _BaseClock:
    """The common part of clocks of all kinds of nodes: `rclpy.clock.BaseClock`."""

    if TYPE_CHECKING:
        __clock: Any
        _clock_type: ClockType

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Self:
        """Make a clock of this kind."""
        if not isinstance(clock_type, (ClockType, _rclpy.ClockType)):
            raise TypeError("Clock type must be a ClockType enum")
        self = super().__new__(cls)
        self.__clock = _rclpy.Clock(clock_type)
        self._clock_type = clock_type
        return self

    @property
    def clock_type(self) -> ClockType:
        """The kind of time."""
        return self._clock_type

    @property
    def handle(self) -> Any:
        """The client library's side, typed as ClockHandle says."""
        return self.__clock

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"

    def now(self) -> Time:
        """Read it."""
        return Time._of_handle(self.__clock.get_now())

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: JumpHandlePreCallbackType | None = None,
        post_callback: Callable[[TimeJump], None] | None = None,
    ) -> JumpHandle:
        """Have callbacks called around jumps, as long as the returned handle lives and is registered.

        They run on the thread that makes the time jump and must not block.
        """
        tell: Callable[[TimeJumpDictionary], None] | None = None
        if post_callback is not None and callable(post_callback):
            told = post_callback

            def tell(jump: TimeJumpDictionary) -> None:
                told(TimeJump(jump["clock_change"], Duration(nanoseconds=jump["delta"])))

        return JumpHandle(clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=tell)

    @property
    def ros_time_is_active(self) -> bool:
        """Whether it shows the time of a time source."""
        if self._clock_type != ClockType.ROS_TIME:
            distro.uses("every_clock")
        with self.handle:
            active: bool = self.handle.get_ros_time_override_is_enabled()
            return active

    def set_ros_time_override(self, time: Time) -> None:
        """Tell it the time that it shows while ROS time is active."""
        if self._clock_type != ClockType.ROS_TIME:
            distro.uses("every_clock")
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        with self.handle:
            self.handle.set_ros_time_override(time._time_handle)


class Clock(_BaseClock):
    """Reads one kind of time. `Clock(clock_type=ClockType.ROS_TIME)` makes a ROSClock."""

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Clock:
        """Make a clock of this kind."""
        kind = ROSClock if clock_type == ClockType.ROS_TIME else cls
        return _BaseClock.__new__(kind, clock_type=clock_type)

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until this clock shows `until`.

        :param context: its shutdown ends the sleep; None: the default one.
        :return: False if the sleep ended early, by a shutdown or because ROS time was switched on or off.
        :raises ValueError: for a time of another kind of clock.
        :raises NotInitializedException: if the context is not up.
        """
        context = get_default_context() if context is None else context
        if not context.ok():
            raise NotInitializedException()
        if int(until.clock_type) != int(self._clock_type):
            raise ValueError("until's clock type does not match this clock's type")
        event = _rclpy.ClockEvent()
        switched = False

        def on_jump(jump: TimeJump) -> None:
            nonlocal switched
            switched |= jump.clock_change in (
                ClockChange.ROS_TIME_ACTIVATED,
                ClockChange.ROS_TIME_DEACTIVATED,
            )
            if switched or self.now() >= until:
                event.set()

        context.on_shutdown(event.set)
        threshold = JumpThreshold(
            min_forward=Duration(nanoseconds=1), min_backward=None, on_clock_change=True
        )
        with self.create_jump_callback(threshold, post_callback=on_jump):
            self._wait(event, until)
        return context.ok() and not switched and self.now() >= until

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a duration of this clock; otherwise as `sleep_until`."""
        return self.sleep_until(self.now() + rel_time, context)

    def _wait(self, event: _rclpy.ClockEvent, until: Time) -> None:
        wait = {
            ClockType.SYSTEM_TIME: event.wait_until_system,
            ClockType.STEADY_TIME: event.wait_until_steady,
            ClockType.ROS_TIME: event.wait_until_ros,
        }[ClockType(self._clock_type)]
        wait(self.handle, until._time_handle)


class ROSClock(Clock):
    """Shows system time, or the time of a time source (/clock)."""

    def __new__(cls) -> ROSClock:
        """Make one."""
        self = super().__new__(cls, clock_type=ClockType.ROS_TIME)
        assert isinstance(self, ROSClock)
        return self

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        """Switch; for the time source that manages this clock."""
        with self.handle:
            self.handle.set_ros_time_override_is_enabled(enabled)

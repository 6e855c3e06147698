"""Timers and rates."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable
from types import FunctionType
from typing import TYPE_CHECKING, Any

from rmw_local import timing

from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle, ROSInterruptException
from rclpy.impl.blocking import Owned
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from rclpy.impl.newer import TimerInfo as TimerInfo  # noqa: PLC0414 - programs import it from here
else:
    __getattr__ = reexport(__name__)


class _BaseTimer:
    """The common part of timers of all kinds of nodes: `rclpy.timer.BaseTimer`. All times in ns."""

    def __init__(
        self,
        callback: Callable[..., object] | None,
        timer_period_ns: int,
        clock: Clock,
        *,
        context: Context | None = None,
        autostart: bool = True,
    ) -> None:
        self._context = get_default_context() if context is None else context
        self._clock = clock
        with self._clock.handle, self._context.handle:
            self.__timer = _rclpy.Timer(
                self._clock.handle, self._context.handle, int(timer_period_ns), autostart
            )
        self.callback = callback

    @property
    def callback(self) -> Callable[..., object] | None:
        """The callback."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., object] | None) -> None:
        self._callback = value
        self._info_parameter = _info_parameter(value)  # the parameter that gets a TimerInfo, if there is one

    @property
    def handle(self) -> _rclpy.Timer:
        """The client library's side."""
        return self.__timer

    def destroy(self) -> None:
        """Destroy it; programs use `Node.destroy_timer`."""
        self.__timer.destroy_when_not_in_use()

    @property
    def clock(self) -> Clock:
        """The clock of the period."""
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        """The period; a new one counts from the next call on."""
        with self.__timer:
            return self.__timer.get_timer_period()

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        with self.__timer:
            self.__timer.change_timer_period(int(value))

    def is_ready(self) -> bool:
        """Return whether the callback is due."""
        with self.__timer:
            return self.__timer.is_timer_ready()

    def is_canceled(self) -> bool:
        """Return whether it is stopped."""
        with self.__timer:
            return self.__timer.is_timer_canceled()

    def cancel(self) -> None:
        """Stop it until `reset`."""
        with self.__timer:
            self.__timer.cancel_timer()

    def reset(self) -> None:
        """Start a whole period now."""
        with self.__timer:
            self.__timer.reset_timer()

    def time_since_last_call(self) -> int:
        """Return how long ago it was called or made."""
        with self.__timer:
            return self.__timer.time_since_last_call()

    def time_until_next_call(self) -> int | None:
        """Return how long until it is due (negative: overdue); None if it is stopped."""
        with self.__timer:
            return self.__timer.time_until_next_call()


class Timer(Owned, _BaseTimer):
    """Calls back every period of its clock; made by `Node.create_timer`. All times in ns.

    :param callback: called without arguments, or with a TimerInfo if the annotation of a parameter says so.
    :param callback_group: decides when it may run.
    :param timer_period_ns: the period.
    :param clock: what measures it.
    :param context: None for the default one.
    :param autostart: False: it runs from the first `reset` on.
    """

    _ros_entity = "Timer"

    def __init__(
        self,
        callback: Callable[..., object] | None,
        callback_group: CallbackGroup | None,
        timer_period_ns: int,
        clock: Clock,
        *,
        context: Context | None = None,
        autostart: bool = True,
    ) -> None:
        super().__init__(callback, timer_period_ns, clock, context=context, autostart=autostart)
        self.callback_group = callback_group
        self._executor_event = False  # a handler exists that has not yet taken its data


def _info_parameter(callback: Callable[..., object] | None) -> str | None:
    """The first parameter whose annotation is the class TimerInfo, not its name."""
    function = getattr(callback, "__func__", callback)
    try:
        if callback is None or (
            isinstance(function, FunctionType) and type not in map(type, function.__annotations__.values())
        ):
            return None  # most callbacks: inspect takes longer than to make a timer
        parameters: Any = inspect.signature(callback).parameters
    except (TypeError, ValueError, NameError):  # written in C, or with names that only checkers import
        return None
    from rclpy.impl.newer import TimerInfo  # late: few programs use it

    return next((each.name for each in parameters.values() if each.annotation is TimerInfo), None)


class Rate:
    """Sleeps until the next beat of a timer; made by `Node.create_rate`. Some executor must run the timer."""

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self._timer = timer
        self._is_shutdown = False
        self._is_destroyed = False
        self._event = timing.Event()
        self._lock = threading.Lock()  # guards the number of sleepers; nothing is called while it is held
        self._num_sleepers = 0
        self._timer.callback = self._event.set
        context.on_shutdown(self._on_shutdown)

    def _on_shutdown(self) -> None:
        self._is_shutdown = True
        self.destroy()

    def destroy(self) -> None:
        """Wake all sleeping threads; later sleeps fail. Programs use `Node.destroy_rate`."""
        self._is_destroyed = True
        self._event.set()

    def sleep(self) -> None:
        """Block until the timer's next beat. In a callback of a single-threaded executor that never comes.

        :raises ROSInterruptException: at shutdown.
        :raises RuntimeError: if it was destroyed.
        """
        self._check()
        with self._lock:
            self._num_sleepers += 1
        try:
            self._event.wait()
        finally:
            with self._lock:
                self._num_sleepers -= 1
                if self._num_sleepers == 0:
                    self._event.clear()
            if self._is_shutdown:
                self.destroy()
                raise ROSInterruptException()

    def _check(self) -> None:
        if self._is_shutdown:
            raise ROSInterruptException()
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        if not self._timer.handle:
            self.destroy()
            raise InvalidHandle("Rate cannot sleep because the timer has been destroyed")

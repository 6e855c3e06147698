"""Waits until a buffer has what a lookup needs."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.task import Future
from tf2_py import InvalidArgumentException, TransformException

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped


class Waiting:
    """Those who wait for transforms: threads, and futures."""

    def __init__(self) -> None:
        # What to call after each new transform; keys are whatever is waiting.
        self._callbacks: dict[object, Callable[[], None]] = {}

    def __len__(self) -> int:
        return len(self._callbacks)

    def wake(self) -> None:
        """Let them look again."""
        if self._callbacks:
            for callback in list(self._callbacks.values()):
                callback()

    def until(self, ask: Callable[[], tuple[bool, str]], timeout: Duration) -> tuple[bool, str]:
        """Block until the answer is yes or the time is up, and return the answer."""
        answer = ask()
        if answer[0] or not is_time(timeout):
            return answer
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        end = clock.now() + timeout
        arrived = threading.Event()
        self._callbacks[arrived] = arrived.set
        try:
            while not (answer := ask())[0]:
                left = (end - clock.now()).nanoseconds * 1e-9
                if left <= 0 or not arrived.wait(min(left, threading.TIMEOUT_MAX)):
                    return ask()
                arrived.clear()
        finally:
            del self._callbacks[arrived]
        return answer

    def future(self, lookup: Callable[[], TransformStamped]) -> Future[TransformStamped]:
        """Return a future that gets the transform as soon as there is one."""
        future: Future[Any] = Future()

        def attempt() -> None:
            try:
                transform = lookup()
            except InvalidArgumentException as error:  # no transform will ever help
                if self._callbacks.pop(future, None):
                    future.set_exception(error)
            except TransformException:
                pass
            else:
                # Transforms may arrive on several threads: one of them completes it.
                if self._callbacks.pop(future, None):
                    future.set_result(transform)

        self._callbacks[future] = attempt
        future.add_done_callback(lambda done: self._callbacks.pop(done, None))
        attempt()
        return future


def is_time(timeout: Any) -> bool:
    """Return whether there is any time to wait.

    :raises TypeError: if it is not a duration.
    """
    if not isinstance(timeout, Duration):
        raise TypeError(f"timeout must be an rclpy.duration.Duration, got {timeout!r}")
    return timeout.nanoseconds > 0

"""A buffer of transforms, and the waits until it has what a lookup needs."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.task import Future
from tf2_msgs.srv import FrameGraph
from tf2_py import BufferCore, InvalidArgumentException, TransformException

from tf2_ros.buffer_interface import BufferInterface

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped
    from rclpy.node import Node
    from rclpy.task import Future
    from tf2_py.buffer_core import DurationLike, TimeLike


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


class Buffer(BufferCore, BufferInterface):
    """A `BufferCore` whose lookups can wait, blocking or in a coroutine.

    It forgets all that is not static when its clock jumps back by a second or more, or changes its source.

    :param cache_time: how long transforms are kept; 10 s if None.
    :param node: offers the frames as the service `tf2_frames`; its clock is the buffer's.
    """

    def __init__(self, cache_time: DurationLike | None = None, node: Node | None = None) -> None:
        # The real BufferCore, which may be beside this package, does not take None.
        BufferCore.__init__(self, *([] if cache_time is None else [cache_time]))
        BufferInterface.__init__(self)
        self._waiting = Waiting()
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self.__get_frames)
        self.clock = Clock() if node is None else node.get_clock()
        threshold = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=True)
        self.jump_handle = self.clock.create_jump_callback(threshold, post_callback=self.time_jump_callback)

    def __get_frames(self, request: FrameGraph.Request, response: FrameGraph.Response) -> FrameGraph.Response:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def time_jump_callback(self, time_jump: TimeJump) -> None:
        """Forget all that is not static."""
        get_logger("tf2_buffer").warning("Detected jump back in time. Clearing tf buffer.")
        self.clear()

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform, and wake those who wait for it."""
        super().set_transform(transform, authority)
        self._waiting.wake()

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform that holds at all times, and wake those who wait for it."""
        super().set_transform_static(transform, authority)
        self._waiting.wake()

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: TimeLike,
        timeout: Duration = Duration(),  # noqa: B008 - never changes
    ) -> TransformStamped:
        """Return the transform that takes coordinates in the source frame to the target frame.

        :param time: a time; zero asks for the latest.
        :param timeout: how long to wait for it, while another thread fills the buffer.
        :raises TransformException: as `lookup_transform_core`, also after the timeout.
        """
        if is_time(timeout):
            self._waiting.until(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_async(
        self, target_frame: str, source_frame: str, time: TimeLike
    ) -> TransformStamped:
        """Wait for a transform, and return it."""
        return await self.wait_for_transform_async(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> TransformStamped:
        """Return the transform between two frames at two times; the fixed frame does not move in between."""
        ends = (target_frame, target_time, source_frame, source_time, fixed_frame)
        if is_time(timeout):
            self._waiting.until(lambda: self.can_transform_full_core(*ends), timeout)
        return self.lookup_transform_full_core(*ends)

    async def lookup_transform_full_async(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
    ) -> TransformStamped:
        """Wait for a transform between two frames at two times, and return it."""
        return await self.wait_for_transform_full_async(
            target_frame, target_time, source_frame, source_time, fixed_frame
        )

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: TimeLike,
        timeout: Duration = Duration(),  # noqa: B008
        return_debug_tuple: bool = False,
    ) -> bool | tuple[bool, str]:
        """Return whether there is a transform; with `return_debug_tuple` also why not."""
        answer = self._waiting.until(
            lambda: self.can_transform_core(target_frame, source_frame, time), timeout
        )
        return answer if return_debug_tuple else answer[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
        return_debug_tuple: bool = False,
    ) -> bool | tuple[bool, str]:
        """Return whether there is a transform between two frames at two times."""
        ends = (target_frame, target_time, source_frame, source_time, fixed_frame)
        answer = self._waiting.until(lambda: self.can_transform_full_core(*ends), timeout)
        return answer if return_debug_tuple else answer[0]

    def wait_for_transform_async(
        self, target_frame: str, source_frame: str, time: TimeLike
    ) -> Future[TransformStamped]:
        """Return a future that gets the transform as soon as there is one."""
        return self._waiting.future(lambda: self.lookup_transform_core(target_frame, source_frame, time))

    def wait_for_transform_full_async(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
    ) -> Future[TransformStamped]:
        """Return a future that gets the transform between two frames at two times as soon as there is one."""
        ends = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return self._waiting.future(lambda: self.lookup_transform_full_core(*ends))

"""Looks transforms up in the buffer of another node."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from rclpy.action.client import ActionClient
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_msgs.action import LookupTransform
from tf2_msgs.msg import TF2Error
from tf2_py import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

from tf2_ros.buffer_interface import BufferInterface

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped
    from rclpy.node import Node
    from rclpy.task import Future
    from tf2_py.buffer_core import TimeLike

# What upstream says of a server that does not answer.
_WRONG = "Something is likely wrong with the server."
_GOAL = "The LookupTransform goal sent to the BufferServer did not come back"

EXCEPTIONS: dict[int, type[TransformException]] = {
    TF2Error.LOOKUP_ERROR: LookupException,
    TF2Error.CONNECTIVITY_ERROR: ConnectivityException,
    TF2Error.EXTRAPOLATION_ERROR: ExtrapolationException,
    TF2Error.INVALID_ARGUMENT_ERROR: InvalidArgumentException,
    TF2Error.TIMEOUT_ERROR: TimeoutException,
}


class BufferClient(BufferInterface):
    """Asks a `BufferServer`. Another thread has to spin the node, because lookups block.

    :param node: sends the requests.
    :param ns: the name of the server's action.
    :param check_frequency: unused: an answer is noticed at once. Upstream looks for it as often [Hz].
    :param timeout_padding: how much longer than the timeout of a lookup to wait for the answer; a number is
        in seconds.
    """

    def __init__(
        self,
        node: Node,
        ns: str,
        check_frequency: float = 10.0,
        timeout_padding: Duration | float = Duration(seconds=2.0),  # noqa: B008 - never changes
    ) -> None:
        super().__init__()
        self.node = node
        self.action_client: ActionClient[Any] = ActionClient(node, LookupTransform, action_name=ns)
        self.check_frequency = check_frequency
        self.timeout_padding = timeout_padding

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: TimeLike,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> TransformStamped:
        """Return the transform that takes coordinates in the source frame to the target frame.

        :raises TransformException: as the server's buffer.
        :raises TimeoutException: if the server does not answer.
        """
        goal = LookupTransform.Goal(
            target_frame=target_frame,
            source_frame=source_frame,
            source_time=_message(time),
            timeout=timeout.to_msg(),
            advanced=False,
        )
        return self._process(goal, timeout)

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
        goal = LookupTransform.Goal(
            target_frame=target_frame,
            source_frame=source_frame,
            source_time=_message(source_time),
            timeout=timeout.to_msg(),
            target_time=_message(target_time),
            fixed_frame=fixed_frame,
            advanced=True,
        )
        return self._process(goal, timeout)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: TimeLike,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> bool:
        """Return whether there is a transform between two frames."""
        try:
            self.lookup_transform(target_frame, source_frame, time, timeout)
        except TransformException:
            return False
        return True

    def can_transform_full(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> bool:
        """Return whether there is a transform between two frames at two times."""
        try:
            self.lookup_transform_full(
                target_frame, target_time, source_frame, source_time, fixed_frame, timeout
            )
        except TransformException:
            return False
        return True

    def _process(self, goal: Any, timeout: Duration) -> TransformStamped:
        if not self.action_client.server_is_ready():
            raise TimeoutException("The BufferServer is not ready.")
        padding = self.timeout_padding
        extra = padding.nanoseconds * 1e-9 if isinstance(padding, Duration) else float(padding)
        limit = timeout.nanoseconds * 1e-9 + extra
        handle = _wait(self.action_client.send_goal_async(goal), limit)
        if not handle.accepted:
            raise TimeoutException(f"{_GOAL} with accepted status. {_WRONG}")
        return _result(_wait(handle.get_result_async(), limit).result)


def _message(time: TimeLike) -> Any:
    return time.to_msg() if isinstance(time, Time) else time


def _wait(future: Future[Any], limit: float) -> Any:
    """Wait until the thread that spins the node has completed a future."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    if not done.wait(min(max(limit, 0.0), threading.TIMEOUT_MAX)):
        future.cancel()
        raise TimeoutException(f"{_GOAL} in the specified time. {_WRONG}")
    return future.result()


def _result(result: LookupTransform.Result) -> TransformStamped:
    error = result.error
    if error.error == TF2Error.NO_ERROR:
        return result.transform
    raise EXCEPTIONS.get(error.error, TransformException)(error.error_string)

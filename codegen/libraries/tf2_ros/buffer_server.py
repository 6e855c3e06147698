"""Lets other nodes look transforms up in a buffer."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from rclpy.action import CancelResponse
from rclpy.action.server import ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_msgs.action import LookupTransform
from tf2_msgs.msg import TF2Error
from tf2_py import BufferCore, TransformException

from tf2_ros.buffer_client import EXCEPTIONS

if TYPE_CHECKING:
    from rclpy.action.server import ServerGoalHandle
    from rclpy.node import Node


class BufferServer:
    """Answers the lookups of `BufferClient`s, of C++ as well, as soon as the buffer has the transform.

    :param buffer: where to look.
    :param node: receives the requests.
    :param ns: the name of the action.
    :param check_period: how often to look for what is missing.
    """

    def __init__(
        self,
        buffer: BufferCore,
        node: Node,
        ns: str,
        check_period: Duration = Duration(seconds=0.01),  # noqa: B008 - never changes
    ) -> None:
        self.buffer = buffer
        self.node = node
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._lock = threading.Lock()
        self._pending: list[tuple[ServerGoalHandle[Any], Time]] = []
        group = ReentrantCallbackGroup()
        self._timer = node.create_timer(
            check_period.nanoseconds * 1e-9, self._check, callback_group=group, clock=self._clock
        )
        self._timer.cancel()  # nothing is missing yet
        self.action_server: ActionServer[Any] = ActionServer(
            node,
            LookupTransform,
            ns,
            self._answer,
            callback_group=group,
            handle_accepted_callback=self._accept,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def destroy(self) -> None:
        """Answer no more."""
        self.node.destroy_timer(self._timer)
        self.action_server.destroy()

    def _accept(self, goal: ServerGoalHandle[Any]) -> None:
        end = self._clock.now() + Duration.from_msg(goal.request.timeout)
        if self._can_transform(goal.request) or end <= self._clock.now():
            goal.execute()
            return
        with self._lock:
            self._pending.append((goal, end))
            self._timer.reset()

    def _check(self) -> None:
        now = self._clock.now()
        with self._lock:
            pending, self._pending = self._pending, []
            ready: list[ServerGoalHandle[Any]] = []
            for goal, end in pending:
                if goal.is_cancel_requested or end <= now or self._can_transform(goal.request):
                    ready.append(goal)
                else:
                    self._pending.append((goal, end))
            if not self._pending:
                self._timer.cancel()
        for goal in ready:
            goal.execute()

    def _can_transform(self, request: Any) -> bool:
        if not request.advanced:
            return self.buffer.can_transform_core(
                request.target_frame, request.source_frame, request.source_time
            )[0]
        return self.buffer.can_transform_full_core(
            request.target_frame,
            request.target_time,
            request.source_frame,
            request.source_time,
            request.fixed_frame,
        )[0]

    def _answer(self, goal: ServerGoalHandle[Any]) -> Any:
        if goal.is_cancel_requested:
            goal.canceled()
            return LookupTransform.Result()
        request, result = goal.request, LookupTransform.Result()
        try:
            if request.advanced:
                result.transform = self.buffer.lookup_transform_full_core(
                    request.target_frame,
                    request.target_time,
                    request.source_frame,
                    request.source_time,
                    request.fixed_frame,
                )
            else:
                result.transform = self.buffer.lookup_transform_core(
                    request.target_frame, request.source_frame, request.source_time
                )
        except TransformException as error:
            result.error = TF2Error(error=_code(error), error_string=str(error))
            goal.abort()
        else:
            goal.succeed()
        return result


def _code(error: TransformException) -> int:
    codes = {kind: code for code, kind in EXCEPTIONS.items()}
    return codes.get(type(error), TF2Error.TRANSFORM_ERROR)

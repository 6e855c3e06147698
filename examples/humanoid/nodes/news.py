"""Waiting for the next message of a topic, in coroutines."""

from __future__ import annotations

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.task import Future

_GONE = 1.0  # s of real time after which whoever sends them counts as gone


class News:
    """The messages of a topic as they come.

    Who asks a server for something may have heard already what the server is only about to hear: before it
    refuses, it waits for the next word.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._waiting: list[Future] = []

    def come(self) -> None:
        """Another message has come."""
        waiting, self._waiting = self._waiting, []
        for future in waiting:
            if not future.done():
                future.set_result(None)

    async def next(self) -> None:
        """Wait until another one comes, or nobody can be expected to send one."""
        self._waiting.append(future := Future())
        timer = self._node.create_timer(
            _GONE,
            self.come,
            callback_group=ReentrantCallbackGroup(),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        try:
            await future
        finally:
            self._node.destroy_timer(timer)

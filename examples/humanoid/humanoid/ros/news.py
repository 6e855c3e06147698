"""Wait for the next message of a topic in coroutines."""

from __future__ import annotations

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.task import Future

_GONE = 1.0  # s of real time without a message after which the sender counts as gone


class News:
    """Lets coroutines wait for the next message of a topic.

    A client of a server may already know something that the server is only about to receive. Before the
    server refuses a request, it therefore waits for the next message.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._waiting: list[Future] = []

    def come(self) -> None:
        """Note that another message has arrived."""
        waiting, self._waiting = self._waiting, []
        for future in waiting:
            if not future.done():
                future.set_result(None)

    async def next(self) -> None:
        """Wait until another message arrives, or until the sender counts as gone."""
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

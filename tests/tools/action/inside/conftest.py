"""An action to look at, and to send goals to."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor


class Counter:
    """`/counter` serves /count: up to `order`, or until it is told to stop."""

    def __init__(self) -> None:
        self.node = rclpy.create_node("counter", start_parameter_services=False, enable_rosout=False)
        self.started, self.cancelled, self.ending = (threading.Event() for _ in range(3))
        self.cancelling = CancelResponse.ACCEPT
        self.server = ActionServer(
            self.node,
            Fibonacci,
            "count",
            self.execute,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=lambda goal: GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT,
            cancel_callback=self.cancel,
        )

    def cancel(self, _: object) -> CancelResponse:
        self.cancelled.set()
        return self.cancelling

    def execute(self, goal: ServerGoalHandle) -> Fibonacci.Result:
        order = goal.request.order
        for number in range(min(order, 3)):
            goal.publish_feedback(Fibonacci.Feedback(sequence=list(range(number + 1))))
        self.started.set()
        if order > 3:  # it takes until somebody ends it
            while not (goal.is_cancel_requested or self.ending.wait(0.01)):
                pass
            if goal.is_cancel_requested:
                goal.canceled()
            else:
                goal.abort()
        elif order == 3:
            goal.abort()
        else:
            goal.succeed()
        return Fibonacci.Result(sequence=list(range(order)))


@pytest.fixture
def counter() -> Iterator[Counter]:
    """The server, and a client in the same node."""
    rclpy.init(args=[], signal_handler_options=rclpy.SignalHandlerOptions.NO)  # Ctrl-C is the tools'
    counter = Counter()
    client = ActionClient(counter.node, Fibonacci, "count")
    yield counter
    client.destroy()
    counter.server.destroy()
    counter.node.destroy_node()
    rclpy.try_shutdown()


@pytest.fixture
def spinning(counter: Counter) -> Iterator[Counter]:
    """The same, in threads that spin it."""
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(counter.node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield counter
    counter.ending.set()
    executor.shutdown()
    thread.join(10.0)

"""Strict mode explains a call that waits for a response which can never be received."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.impl import blocking
from rclpy.impl.blocking import SynchronousCallError
from rclpy.node import Node
from std_srvs.srv import Empty
from test_msgs.action import Fibonacci


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    blocking.enabled = True
    node = rclpy.create_node("n")
    node.create_service(
        Empty, "e", lambda _, response: response, callback_group=MutuallyExclusiveCallbackGroup()
    )
    yield node
    blocking.enabled = False
    rclpy.shutdown()


def outcome_of_call(
    node: Node, executor: Executor, group: CallbackGroup | None, timeout: float | None
) -> Any:
    """The outcome of a call in a timer's callback of this group; the client is in the node's own group."""
    client = node.create_client(Empty, "e")
    outcomes: list[Any] = []

    def ask() -> None:
        timer.cancel()
        try:
            outcomes.append(client.call(Empty.Request(), timeout_sec=timeout))
        except SynchronousCallError as error:
            outcomes.append(str(error))

    timer = node.create_timer(0.001, ask, callback_group=group)
    executor.add_node(node)
    for _ in range(100):
        if outcomes:
            return outcomes[0]
        executor.spin_once(timeout_sec=0.1)
    raise AssertionError("the callback did not end")


def test_the_only_thread(node: Node) -> None:
    other = MutuallyExclusiveCallbackGroup()
    text = outcome_of_call(node, SingleThreadedExecutor(), other, None)
    assert text.startswith("The call of service 'e' would block for ever: ")
    assert "only thread" in text
    assert "await client.call_async(request)" in text


def test_the_same_callback_group(node: Node) -> None:
    text = outcome_of_call(node, MultiThreadedExecutor(num_threads=2), None, 5)
    assert text.startswith("The call of service 'e' would time out after 5 s: ")
    assert "callback group" in text


def test_a_call_that_is_answered_goes_through(node: Node) -> None:
    other = MutuallyExclusiveCallbackGroup()
    assert outcome_of_call(node, MultiThreadedExecutor(num_threads=2), other, 10) == Empty.Response()


def test_coroutines_and_tasks_count_as_callbacks(node: Node) -> None:
    client, executor = node.create_client(Empty, "e"), SingleThreadedExecutor()
    executor.add_node(node)

    async def ask() -> Any:
        return client.call(Empty.Request())

    executor.create_task(ask)
    with pytest.raises(SynchronousCallError, match="only thread"):
        executor.spin_once(timeout_sec=1)
    node.create_timer(0.001, ask)
    with pytest.raises(SynchronousCallError, match="callback group"):
        for _ in range(10):
            executor.spin_once(timeout_sec=1)


def test_outside_of_callbacks_nothing_changes(node: Node) -> None:
    client, executor = node.create_client(Empty, "e"), SingleThreadedExecutor()
    executor.add_node(node)
    answers: list[Any] = []
    thread = threading.Thread(target=lambda: answers.append(client.call(Empty.Request(), timeout_sec=10)))
    thread.start()
    while thread.is_alive():
        executor.spin_once(timeout_sec=0.05)
    assert answers == [Empty.Response()]


def act_in_callback(node: Node, client: ActionClient, executor: Executor, act: Any) -> Any:
    """The outcome of `act` in a timer's callback with a group of its own."""
    outcomes: list[Any] = []

    def callback() -> None:
        timer.cancel()
        try:
            outcomes.append(act(client))
        except SynchronousCallError as error:
            outcomes.append(str(error))

    timer = node.create_timer(0.001, callback, callback_group=MutuallyExclusiveCallbackGroup())
    executor.add_node(node)
    for _ in range(100):
        if outcomes:
            return outcomes[0]
        executor.spin_once(timeout_sec=0.1)
    raise AssertionError("the callback did not end")


def serve(node: Node) -> ActionServer:
    def execute(goal: Any) -> Any:
        goal.succeed()
        return Fibonacci.Result(sequence=[1])

    return ActionServer(node, Fibonacci, "f", execute, callback_group=MutuallyExclusiveCallbackGroup())


def test_goals_that_are_waited_for_on_the_only_thread(node: Node) -> None:
    server, client, executor = serve(node), ActionClient(node, Fibonacci, "f"), SingleThreadedExecutor()
    executor.add_node(node)
    text = act_in_callback(node, client, executor, lambda client: client.send_goal(Fibonacci.Goal()))
    assert text.startswith("The call of action 'f' would block for ever: ")
    assert "only thread" in text
    assert "await client.send_goal_async(goal)" in text

    sending = client.send_goal_async(Fibonacci.Goal())
    executor.spin_until_future_complete(sending, timeout_sec=10)
    for method in ("get_result", "cancel_goal"):
        handle = sending.result()
        text = act_in_callback(node, client, executor, lambda _: getattr(handle, method)())  # noqa: B023
        assert f"await goal_handle.{method}_async()" in text
    server.destroy()


def test_goals_that_another_thread_answers_go_through(node: Node) -> None:
    server, client = serve(node), ActionClient(node, Fibonacci, "f")
    executor = MultiThreadedExecutor(num_threads=3)
    answer = act_in_callback(node, client, executor, lambda client: client.send_goal(Fibonacci.Goal()))
    assert list(answer.result.sequence) == [1]
    server.destroy()

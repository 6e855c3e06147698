"""Executors with threads, the cost of idle entities, and callbacks that must not get lost."""

from __future__ import annotations

import gc
import sys
import threading
import time
import weakref
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Int32, String
from std_srvs.srv import Empty

EXECUTORS = [SingleThreadedExecutor, lambda: MultiThreadedExecutor(num_threads=3), EventsExecutor]
IDS = ["single", "multi", "events"]


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    node = rclpy.create_node("n")
    yield node
    rclpy.try_shutdown()


def spin_until(executor: Executor, condition: Any, seconds: float = 10.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        executor.spin_once(timeout_sec=0.05)


@pytest.mark.parametrize("make_executor", EXECUTORS, ids=IDS)
def test_two_publishers_on_one_topic_lose_nothing(node: Node, make_executor: Any) -> None:
    executor = make_executor()
    executor.add_node(node)
    got: list[int] = []
    group = MutuallyExclusiveCallbackGroup()
    node.create_subscription(Int32, "t", lambda m: got.append(m.data), 2000, callback_group=group)

    def publish(first: int) -> None:
        publisher = node.create_publisher(Int32, "t", 2000)
        for number in range(first, first + 500):
            publisher.publish(Int32(data=number))

    threads = [threading.Thread(target=publish, args=(first,)) for first in (0, 1000)]
    for thread in threads:
        thread.start()
    spin_until(executor, lambda: len(got) == 1000)
    for thread in threads:
        thread.join(10)
    assert [number for number in got if number < 1000] == list(range(500))
    assert [number for number in got if number >= 1000] == list(range(1000, 1500))


@pytest.mark.parametrize("make_executor", EXECUTORS, ids=IDS)
def test_entities_come_and_go_while_it_spins(node: Node, make_executor: Any) -> None:
    executor = make_executor()
    executor.add_node(node)
    spinner = threading.Thread(target=executor.spin, daemon=True)
    spinner.start()
    beats: list[int] = []
    steady = node.create_timer(0.001, lambda: beats.append(1), callback_group=ReentrantCallbackGroup())
    seen = threading.Event()
    for number in range(60):
        seen.clear()
        publisher = node.create_publisher(String, f"t{number % 3}", 10)
        subscription = node.create_subscription(String, f"t{number % 3}", lambda _: seen.set(), 10)
        timer = node.create_timer(0.001, lambda: None)
        guard = node.create_guard_condition(lambda: None)
        publisher.publish(String(data="x"))
        guard.trigger()
        assert seen.wait(10), f"the subscription of round {number} was never called"
        assert node.destroy_subscription(subscription)
        assert node.destroy_timer(timer)
        assert node.destroy_guard_condition(guard)
        assert node.destroy_publisher(publisher)
    assert beats
    node.destroy_timer(steady)
    executor.shutdown()
    spinner.join(10)
    assert not spinner.is_alive()


@pytest.mark.parametrize("make_executor", EXECUTORS, ids=IDS)
def test_shutdown_from_a_callback_ends_spin(node: Node, make_executor: Any) -> None:
    executor = make_executor()
    executor.add_node(node)
    node.create_timer(0.01, rclpy.shutdown)
    spinner = threading.Thread(target=executor.spin, daemon=True)
    spinner.start()
    spinner.join(10)
    assert not spinner.is_alive()
    assert not rclpy.ok()


@pytest.mark.parametrize("make_executor", EXECUTORS, ids=IDS)
def test_everything_wakes_a_blocked_wait(node: Node, make_executor: Any) -> None:
    executor = make_executor()
    executor.add_node(node)
    for wake in (
        lambda: executor.create_task(lambda: None),
        lambda: node.create_timer(0.0, lambda: None).cancel(),
        executor.wake,
        executor.shutdown,
    ):
        done = Future()
        waiter = threading.Thread(target=executor.spin_until_future_complete, args=(done, 20), daemon=True)
        waiter.start()
        wake()
        done.set_result(None)
        waiter.join(10)
        assert not waiter.is_alive()


def test_a_node_may_be_spun_inside_its_own_callback_by_another_executor_only(node: Node) -> None:
    executor, other = SingleThreadedExecutor(), SingleThreadedExecutor()
    executor.add_node(node)
    server = rclpy.create_node("server")
    server.create_service(Empty, "e", lambda _, response: response)
    client = server.create_client(Empty, "e")
    other.add_node(server)
    answers: list[Any] = []

    def ask() -> None:
        timer.cancel()
        assert executor.is_spinning
        with pytest.raises(RuntimeError, match=r"^Executor is already spinning: .*await"):
            executor.spin_once(timeout_sec=0)
        with pytest.raises(RuntimeError, match="already spinning"):
            rclpy.spin_until_future_complete(node, Future(), executor)
        future = client.call_async(Empty.Request())
        other.spin_until_future_complete(future, timeout_sec=5)
        answers.append(future.result())

    timer = node.create_timer(0.001, ask)
    spin_until(executor, lambda: answers)
    assert answers == [Empty.Response()]
    assert not executor.is_spinning
    server.destroy_node()


def test_an_awaiting_callback_occupies_its_group_only(node: Node) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    gate, seen = Future(), []

    async def waits() -> None:
        timer.cancel()
        await gate
        seen.append("awaited")

    timer = node.create_timer(0.001, waits)
    node.create_timer(0.001, lambda: seen.append("same group"))
    node.create_timer(0.001, lambda: seen.append("other group"), callback_group=ReentrantCallbackGroup())
    spin_until(executor, lambda: seen.count("other group") > 5)
    assert "same group" not in seen
    gate.set_result(None)
    spin_until(executor, lambda: "same group" in seen)
    assert "awaited" in seen


def test_idle_entities_are_not_asked(node: Node) -> None:
    """The work per message does not grow with the number of entities: idle handles are not even checked."""
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    timers = [node.create_timer(3600.0, lambda: None) for _ in range(200)]
    for number in range(100):
        node.create_subscription(String, f"idle{number}", lambda _: None, 10)
    got: list[Any] = []
    publisher = node.create_publisher(String, "busy", 10)
    node.create_subscription(String, "busy", got.append, 10)
    for _ in range(5):
        executor.spin_once(timeout_sec=0)
    asked: list[Any] = []
    for timer in timers:
        real = timer.handle.is_ready
        timer.handle.is_ready = lambda real=real: asked.append(1) or real()  # type: ignore[method-assign]
    for _ in range(50):
        publisher.publish(String(data="x"))
        executor.spin_once(timeout_sec=1)
    assert len(got) == 50
    assert asked == []


def test_a_crowd_that_has_become_idle_leaves_nothing_to_go_through(node: Node) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    subscriptions = [
        node.create_subscription(String, f"t{number}", lambda _: None, 10) for number in range(500)
    ]
    executor.spin_once(timeout_sec=0)
    assert len(executor._queue._watches) > len(subscriptions)
    assert sys.getsizeof(executor._queue._candidates) < 2000


def test_a_worker_finds_something_destroyed_while_the_executor_looks(node: Node) -> None:
    """The callback of another thread may find that nothing is left to take, at any moment of the search."""
    heard = node.create_subscription(String, "heard", lambda _: None, 1)
    gone = node.create_subscription(String, "gone", lambda _: None, 1)
    node.create_publisher(String, "heard", 1).publish(String())
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    queue = executor._queue
    queue.watch([node])
    watch = queue._watches[id(gone)]
    gone.handle.destroy_when_not_in_use()

    def may_execute(entity: Any) -> bool:
        if entity is heard:
            queue.drop_if_destroyed(watch)
        return True

    assert heard in [each.entity for each in queue.collect(may_execute, None)]
    queue.collect(may_execute, None)
    assert watch not in queue._candidates


def test_memory_does_not_grow_with_messages_or_timer_resets(node: Node) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    publisher = node.create_publisher(String, "t", 10)
    watchdog = node.create_timer(3600.0, lambda: None)
    node.create_subscription(String, "t", lambda _: watchdog.reset(), 10)

    def pass_messages(count: int) -> int:
        for _ in range(count):
            publisher.publish(String(data="x"))
            executor.spin_once(timeout_sec=1)
        gc.collect()
        return len(gc.get_objects())

    pass_messages(100)
    assert pass_messages(2000) - pass_messages(100) < 50


def test_an_executor_without_references_is_collected(node: Node) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    node.create_timer(0.001, lambda: None)
    executor.spin_once(timeout_sec=1)
    del executor
    gc.collect()
    assert node.executor is None


@pytest.mark.parametrize("make_executor", EXECUTORS, ids=IDS)
def test_a_coroutine_that_waits_keeps_nothing_else_from_running(node: Node, make_executor: Any) -> None:
    executor = make_executor()
    executor.add_node(node)
    group = ReentrantCallbackGroup()
    never, released = Future(), Future()
    beats: list[int] = []

    async def answer(_: Any, response: Any) -> Any:
        await released
        return response

    node.create_service(Empty, "s", answer, callback_group=group)
    client = node.create_client(Empty, "s", callback_group=group)
    node.create_timer(0.01, lambda: beats.append(1), callback_group=group)

    async def wait_for(future: Future) -> None:
        await future

    executor.create_task(wait_for, never)
    response = client.call_async(Empty.Request())
    spin_until(executor, lambda: len(beats) > 3)
    assert not response.done()
    task = executor.create_task(released.set_result, None)
    spin_until(executor, response.done)
    assert task.done()


def test_the_events_executor_runs_all_that_is_ready_though_the_time_is_over(node: Node) -> None:
    executor = EventsExecutor()
    executor.add_node(node)
    got: list[int] = []
    forward = node.create_publisher(Int32, "b", 10)
    node.create_subscription(Int32, "a", forward.publish, 10)
    node.create_subscription(Int32, "b", lambda m: got.append(m.data), 10)
    first = node.create_publisher(Int32, "a", 10)
    for number in range(5):
        first.publish(Int32(data=number))
    executor.spin_until_future_complete(Future(), timeout_sec=0)
    assert got == [0, 1, 2, 3, 4]


def test_the_events_executor_ignores_callback_groups(node: Node) -> None:
    executor = EventsExecutor()
    executor.add_node(node)
    client = node.create_client(Empty, "s")
    node.create_service(Empty, "s", lambda _, response: response)
    answered = Future()

    async def ask() -> None:
        timer.cancel()
        answered.set_result(await client.call_async(Empty.Request()))

    timer = node.create_timer(0.001, ask)
    spin_until(executor, answered.done)


@pytest.mark.timeout(20)
def test_a_time_limit_that_passes_while_the_executor_is_awake_is_seen(node: Node) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)  # wakes it, so that the first wait ends at once, and then the time is up
    executor.spin_once(timeout_sec=1e-9)


def test_nodes_that_a_program_drops_become_garbage(node: Node) -> None:
    """This holds for nodes in an executor of their own and in the global one, which remembers the last."""

    def drop(spin: Any) -> weakref.ref[Node]:
        dropped = Node("dropped")
        dropped.create_subscription(String, "t", lambda _: None, 1)
        dropped.create_timer(100.0, lambda: None)
        spin(dropped)
        return weakref.ref(dropped)

    def spin_in_own_executor(dropped: Node) -> None:
        executor = SingleThreadedExecutor()
        executor.add_node(dropped)
        executor.spin_once(timeout_sec=0)

    references = [drop(spin_in_own_executor), drop(lambda dropped: rclpy.spin_once(dropped, timeout_sec=0))]
    rclpy.spin_once(node, timeout_sec=0)
    gc.collect()
    assert [reference() for reference in references] == [None, None]


def test_executors_that_a_program_drops_leave_no_listeners(node: Node) -> None:
    subscription = node.create_subscription(String, "t", lambda _: None, 1)
    done = Future()
    done.set_result(None)
    for _ in range(5):
        rclpy.spin_until_future_complete(node, done, SingleThreadedExecutor())
        rclpy.spin_once(node, timeout_sec=0, executor=SingleThreadedExecutor())
        gc.collect()
    assert len(subscription.handle._source._listeners) <= 2


def test_futures_of_an_executor_run_their_callbacks_there(node: Node) -> None:
    executor = SingleThreadedExecutor()
    future = executor.create_future()
    called: list[Future] = []
    future.add_done_callback(called.append)
    future.set_result(1)
    assert not called
    executor.spin_once(timeout_sec=0)
    assert called == [future]

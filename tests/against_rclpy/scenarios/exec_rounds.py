"""One spin_once: order, timeouts, tasks, coroutines, exceptions, and the generator that it uses."""

from __future__ import annotations

import threading
import time
from typing import Any

import rclpy
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import (
    ConditionReachedException,
    ExternalShutdownException,
    MultiThreadedExecutor,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
    await_or_execute,
)
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Empty
from transcript import attempt, until

seen: list[Any] = []


class Pause:
    """Suspends a coroutine once."""

    def __await__(self) -> Any:
        yield


def rounds(executor: Any, count: int, timeout: float) -> None:
    for number in range(count):
        executor.spin_once(timeout_sec=timeout)
        print(number, timeout, seen)
    seen.clear()


def drain(executor: Any) -> None:
    for _ in range(20):
        executor.spin_once(timeout_sec=0.01)
    seen.clear()


def order_of_kinds(node: Any, executor: Any) -> None:
    publisher = node.create_publisher(String, "t", 10)
    subscription = node.create_subscription(String, "t", lambda m: seen.append(f"sub {m.data}"), 10)
    guards = [node.create_guard_condition(lambda i=i: seen.append(f"guard {i}")) for i in range(2)]
    service = node.create_service(Empty, "e", lambda q, r: seen.append("service") or r)
    client = node.create_client(Empty, "e")
    until(lambda: publisher.get_subscription_count() and client.service_is_ready(), executor)
    drain(executor)
    for timeout in (0.05, 0):
        for number in range(3):
            publisher.publish(String(data=str(number)))
        for guard in guards:
            guard.trigger()
            guard.trigger()
        future = client.call_async(Empty.Request())
        future.add_done_callback(lambda _: seen.append("answer"))
        timers = [node.create_timer(0.01, lambda i=i: seen.append(f"timer {i}")) for i in range(2)]
        time.sleep(0.3)
        for timer in timers:
            timer.timer_period_ns = 10**12
        rounds(executor, 14 if timeout else 18, timeout)
        for timer in timers:
            node.destroy_timer(timer)
        drain(executor)
    for entity in (subscription, service, client):
        print(
            node.destroy_subscription(entity) or node.destroy_service(entity) or node.destroy_client(entity)
        )
    for guard in guards:
        print(node.destroy_guard_condition(guard))


def tasks(executor: Any) -> None:
    made = [executor.create_task(lambda i=i: seen.append(i) or i) for i in range(3)]
    rounds(executor, 5, 0)
    print([task.result() for task in made], [task.done() for task in made])

    async def steps(name: str) -> str:
        for number in range(3):
            seen.append(f"{name}{number}")
            await Pause()
        return name

    two = [executor.create_task(steps, "a"), executor.create_task(steps("b"))]
    for _ in range(12):  # since 7.1.9 a task that has just stepped costs no round without a step
        executor.spin_once(timeout_sec=0.01)
    print(seen)
    seen.clear()
    print([task.result() for task in two])
    waiting = Future(executor=executor)

    async def waits() -> Any:
        return await waiting

    task = executor.create_task(waits)
    executor.create_task(lambda: waiting.set_result(7))
    for _ in range(4):
        executor.spin_once(timeout_sec=0.05)
    print(task.done(), task.result())

    async def raises() -> None:
        await Pause()
        raise ValueError("late")

    task = executor.create_task(raises)
    executor.spin_once(timeout_sec=0)
    attempt("second step", lambda: executor.spin_once(timeout_sec=0.1))
    attempt("second step", lambda: executor.spin_once(timeout_sec=0.1))
    print(task.done(), repr(task.exception()))
    attempt("await_or_execute", lambda: await_or_execute(lambda x: x + 1, 1).send(None))
    waiting = Future()
    endless = executor.create_task(waits)
    executor.spin_once(timeout_sec=0)
    endless.cancel()
    print(endless.cancelled(), endless.done(), endless.result())
    executor.spin_until_future_complete(endless, 1)
    drain(executor)


def exceptions(node: Any, executor: Any) -> None:
    def bad() -> None:
        raise ValueError("boom")

    timer = node.create_timer(0.01, bad)
    attempt("callback raises", lambda: executor.spin_once(timeout_sec=1))
    timer.cancel()
    attempt("afterwards", lambda: executor.spin_once(timeout_sec=0.05))
    attempt("task raises", lambda: (executor.create_task(bad), executor.spin_once(timeout_sec=1)))
    node.destroy_timer(timer)
    future = Future()

    async def awaits() -> None:
        seen.append("begin")
        await future
        seen.append("end")

    timer = node.create_timer(0.01, awaits)
    other = node.create_timer(0.01, lambda: seen.append("other"), callback_group=ReentrantCallbackGroup())
    same = node.create_timer(0.01, lambda: seen.append("same"))
    until(lambda: seen.count("other") > 3, executor)
    print(seen[0], seen.count("begin"), seen.count("same"), seen.count("other") > 3)
    timer.cancel()
    future.set_result(None)
    until(lambda: seen.count("same") > 3, executor)
    print(seen.count("end"), seen.count("same") > 3)
    for each in (timer, other, same):
        node.destroy_timer(each)
    drain(executor)


def the_generator(node: Any, executor: Any) -> None:
    attempt("nothing", lambda: executor.wait_for_ready_callbacks(timeout_sec=0))
    attempt("condition", lambda: executor.wait_for_ready_callbacks(timeout_sec=0, condition=lambda: True))
    timers = [node.create_timer(0.001, lambda i=i: seen.append(i)) for i in range(2)]
    time.sleep(0.05)
    found = [executor.wait_for_ready_callbacks(timeout_sec=0.5) for _ in range(2)]
    print([(entity is timer, owner is node) for (_, entity, owner), timer in zip(found, timers)])
    for handler, entity, _ in found:
        print(handler.done(), executor.can_execute(entity))
        handler()
        print(handler.done(), handler.result(), executor.can_execute(entity), seen)
    for timer in timers:
        node.destroy_timer(timer)
    drain(executor)
    other = rclpy.create_node("other")
    timers = [each.create_timer(0.001, lambda: None) for each in (node, other)]
    time.sleep(0.05)
    handler, entity, owner = executor.wait_for_ready_callbacks(timeout_sec=0.5, nodes=[other])
    print(entity is timers[1], owner is other)
    handler()
    attempt("unready", lambda: next(executor._wait_for_ready_callbacks(timeout_sec=0, nodes=[])))
    other.destroy_node()
    node.destroy_timer(timers[0])
    drain(executor)


def groups() -> None:
    group = MutuallyExclusiveCallbackGroup()
    thing, other = Thing(), Thing()
    group.add_entity(thing)
    print(group.has_entity(thing), group.has_entity(other), group.can_execute(thing))
    print(group.beginning_execution(thing), group.beginning_execution(thing), group.can_execute(thing))
    group.ending_execution(thing)
    print(group.can_execute(thing), len(group.entities))
    reentrant = ReentrantCallbackGroup()
    print(
        reentrant.beginning_execution(thing), reentrant.can_execute(thing), reentrant.ending_execution(thing)
    )
    for call in ("can_execute", "beginning_execution", "ending_execution"):
        attempt(call, lambda: getattr(CallbackGroup(), call)(thing))


class Thing:
    """An object that can be weakly referenced."""


def many_threads(node: Any) -> None:
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(node)
    group = ReentrantCallbackGroup()
    gate, inside = threading.Barrier(3, timeout=10), []

    def meet() -> None:
        if len(inside) < 3:
            inside.append(1)
            gate.wait()
            seen.append("met")

    timers = [node.create_timer(0.01, meet, callback_group=group) for _ in range(3)]
    end = time.monotonic() + 5
    while len(seen) < 3 and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)
    print(seen)
    for timer in timers:
        node.destroy_timer(timer)

    def bad() -> None:
        raise ValueError("from the pool")

    task = executor.create_task(bad)
    came_out: list[str] = []

    def spin(timeout: float) -> None:
        try:
            executor.spin_once(timeout_sec=timeout)
        except ValueError as error:
            came_out.append(str(error))

    spin(0)
    while not task.done():  # something else may be ready first
        time.sleep(0.01)
        spin(0)
    executor.create_task(lambda: None)
    for _ in range(3):
        spin(0.1)
    print("came out:", came_out)
    print(executor.shutdown(), executor.get_nodes())
    seen.clear()


def nodes_and_ends() -> None:
    node, executor, other = rclpy.create_node("m"), SingleThreadedExecutor(), SingleThreadedExecutor()
    print(executor.add_node(node), executor.add_node(node), node.executor is executor)
    print(other.add_node(node), node.executor is other, executor.get_nodes(), len(other.get_nodes()))
    rclpy.spin_once(node, timeout_sec=0)
    print(node.executor is rclpy.get_global_executor(), other.get_nodes())
    executor.add_node(node)
    executor.remove_node(node)
    print(executor.remove_node(node), executor.get_nodes())
    started = time.monotonic()
    threading.Timer(0.2, lambda: executor.create_task(lambda: seen.append("woken"))).start()
    executor.spin_once()
    print(seen, time.monotonic() - started > 0.1)
    threading.Timer(0.2, executor.shutdown).start()
    executor.spin()
    attempt("spin_once", lambda: executor.spin_once(timeout_sec=0.1))
    attempt("generator", lambda: executor.wait_for_ready_callbacks(timeout_sec=0.1))
    with SingleThreadedExecutor() as scoped:
        scoped.add_node(node)
    print(scoped.get_nodes())
    attempt("abstract", lambda: rclpy.executors.Executor().spin_once())
    timer = node.create_timer(0.05, rclpy.shutdown)
    attempt("spin", lambda: rclpy.spin(node))
    print(rclpy.ok(), timer is not None)
    attempt("spin_once after", lambda: other.spin_once(timeout_sec=0.1))
    attempt("spin_once after", lambda: other.spin_once())
    attempt("spin after", other.spin)
    print(
        issubclass(ExternalShutdownException, Exception),
        [
            each.__mro__[1].__name__
            for each in (ShutdownException, TimeoutException, ConditionReachedException)
        ],
    )
    for _ in range(2):
        rclpy.init()
        node = rclpy.create_node("again")
        future = Future()
        threading.Timer(0.1, lambda: future.set_result(3)).start()
        attempt("future", lambda: rclpy.spin_until_future_complete(node, future, timeout_sec=5))
        print(future.result(), node.executor is rclpy.get_global_executor())
        started = time.monotonic()
        rclpy.spin_until_future_complete(node, Future(), timeout_sec=0.2)
        print(time.monotonic() - started > 0.15)
        rclpy.shutdown()


def main() -> None:
    """Print it all."""
    rclpy.init()
    node = rclpy.create_node("n")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    drain(executor)
    order_of_kinds(node, executor)
    tasks(executor)
    exceptions(node, executor)
    the_generator(node, executor)
    groups()
    executor.remove_node(node)
    many_threads(node)
    nodes_and_ends()

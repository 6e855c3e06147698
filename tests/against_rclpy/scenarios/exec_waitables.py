"""Waitables that a program writes around every kind of handle, and an executor built on the public iterator."""

from __future__ import annotations

import threading
from typing import Any

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.executors import (
    Executor,
    ExternalShutdownException,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
)
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.qos import QoSProfile
from rclpy.task import Future
from rclpy.type_support import check_for_type_support
from rclpy.waitable import NumberOfEntities, Waitable
from std_msgs.msg import String
from std_srvs.srv import Empty
from transcript import attempt, until

QOS = QoSProfile(depth=10).get_c_qos_profile()


class Around(Waitable):
    """A waitable for one handle, with the index that the wait set returned."""

    def __init__(self, node: Any, kind: str, handle: Any, take: Any) -> None:
        super().__init__(ReentrantCallbackGroup())
        self.kind, self.handle, self.take = kind, handle, take
        self.index: int | None = None
        self.ready = False
        self.future = Future()
        self.node = node
        node.add_waitable(self)
        self.add_future(self.future)

    def is_ready(self, wait_set: Any) -> bool:
        self.ready = wait_set.is_ready(self.kind, self.index)
        return self.ready

    def take_data(self) -> Any:
        return self.take(self.handle) if self.ready else None

    async def execute(self, taken_data: Any) -> None:
        if not self.future.done():
            self.future.set_result(taken_data)

    def get_num_entities(self) -> NumberOfEntities:
        counts = {"subscription": (1,), "guard_condition": (0, 1), "timer": (0, 0, 1), "client": (0, 0, 0, 1)}
        return NumberOfEntities(*counts.get(self.kind, (0, 0, 0, 0, 1)))

    def add_to_wait_set(self, wait_set: Any) -> None:
        self.index = getattr(wait_set, f"add_{self.kind}")(self.handle)


def first_result(executor: Any, waitable: Around, show: Any) -> None:
    executor.spin_until_future_complete(waitable.future, 5)
    print(
        waitable.kind, waitable.future.done(), attempt("taken", lambda: show(waitable.future.result()), str)
    )
    waitable.node.remove_waitable(waitable)


def call_timer(handle: Any) -> str:
    handle.call_timer()
    return "called"


def around_every_kind(node: Any, executor: Any) -> None:
    context = node.context.handle
    with node.handle:
        guard = _rclpy.GuardCondition(context)
    waitable = Around(node, "guard_condition", guard, lambda handle: "seen")
    threading.Timer(0.1, guard.trigger_guard_condition).start()
    first_result(executor, waitable, str)
    clock = Clock(clock_type=ClockType.STEADY_TIME)
    timer = _rclpy.Timer(clock.handle, context, 50_000_000, True)
    first_result(executor, Around(node, "timer", timer, call_timer), str)
    publisher = node.create_publisher(String, "t", 10)
    subscription = _rclpy.Subscription(node.handle, String, "t", QOS)
    waitable = Around(node, "subscription", subscription, lambda handle: handle.take_message(String, False))
    until(lambda: publisher.get_subscription_count(), executor)
    publisher.publish(String(data="hello"))
    first_result(executor, waitable, lambda taken: (taken[0].data, sorted(taken[1])))
    check_for_type_support(Empty)
    server = _rclpy.Service(node.handle, Empty, "e", QOS)
    waitable = Around(node, "service", server, lambda handle: handle.service_take_request(Empty.Request))
    client = _rclpy.Client(node.handle, Empty, "e", QOS)
    until(client.service_server_is_available, executor)
    print(client.send_request(Empty.Request()))
    first_result(executor, waitable, lambda taken: (taken[0], type(taken[1]).__name__))
    answered = Around(node, "client", client, lambda handle: handle.take_response(Empty.Response))
    server.service_send_response(Empty.Response(), waitable.future.result()[1].request_id)
    first_result(executor, answered, lambda taken: (taken[0].request_id.sequence_number, taken[1]))


def occupied_group(node: Any, executor: Any) -> None:
    """Entities that become ready while their group is busy are not lost."""
    group = MutuallyExclusiveCallbackGroup()
    guard = _rclpy.GuardCondition(node.context.handle)
    waitable = Around(node, "guard_condition", guard, lambda handle: "later")
    waitable.callback_group = group
    group.add_entity(waitable)
    gate = Future()

    occupied: list[bool] = []

    async def occupies() -> None:
        occupied.append(True)
        await gate

    timer = node.create_timer(0.01, occupies, callback_group=group)
    until(lambda: occupied, executor)
    timer.cancel()
    guard.trigger_guard_condition()
    for _ in range(5):
        executor.spin_once(timeout_sec=0.01)
    print(waitable.future.done())
    gate.set_result(None)
    executor.spin_until_future_complete(waitable.future, 2)
    print(waitable.future.done())
    node.remove_waitable(waitable)
    node.destroy_timer(timer)


def the_base_class() -> None:
    waitable = Waitable(ReentrantCallbackGroup())
    for call in (
        lambda: waitable.is_ready(None),
        waitable.take_data,
        waitable.get_num_entities,
        lambda: waitable.add_to_wait_set(None),
        lambda: waitable.execute(None).send(None),
    ):
        attempt("abstract", call)
    with waitable:
        total = NumberOfEntities(1, 2, 3) + NumberOfEntities(num_clients=4, num_services=5, num_events=6)
    print(total, total.num_subscriptions, total.num_events)


class Priority(Executor):
    """Runs urgent callbacks first, as a program could with `wait_for_ready_callbacks`."""

    def spin_once(self, timeout_sec: Any = None) -> None:
        try:
            handler, entity, node = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
        except (TimeoutException, ShutdownException, ExternalShutdownException):
            return
        handler()
        if handler.exception() is not None:
            raise handler.exception()


def own_executor(node: Any) -> None:
    executor, seen = Priority(), []
    executor.add_node(node)
    timers = [node.create_timer(0.02, lambda i=i: seen.append(i)) for i in range(2)]
    until(lambda: len(seen) >= 6, executor)
    print(seen)
    for timer in timers:
        node.destroy_timer(timer)

    def bad() -> None:
        raise KeyError("own")

    executor.create_task(bad)
    attempt("raises", lambda: executor.spin_once(timeout_sec=0.1))
    guard = node.create_guard_condition(lambda: executor.shutdown())
    guard.trigger()
    executor.spin()
    print("spun", len(executor.get_nodes()))


def wait_sets(node: Any) -> None:
    context = node.context.handle
    wait_set = _rclpy.WaitSet(0, 1, 1, 0, 0, 0, context)
    guard = _rclpy.GuardCondition(context)
    timer = _rclpy.Timer(Clock(clock_type=ClockType.STEADY_TIME).handle, context, 50_000_000, True)
    wait_set.clear_entities()
    print(wait_set.add_guard_condition(guard), wait_set.add_timer(timer))
    wait_set.wait(0)
    print(wait_set.get_ready_entities("guard_condition"), wait_set.get_ready_entities("timer"))
    wait_set.clear_entities()
    wait_set.add_guard_condition(guard), wait_set.add_timer(timer)
    wait_set.wait(-1)
    print(wait_set.get_ready_entities("timer") == [timer.pointer], wait_set.is_ready("timer", 0))
    guard.trigger_guard_condition()
    wait_set.clear_entities()
    wait_set.add_guard_condition(guard)
    wait_set.wait(-1)
    print(wait_set.get_ready_entities("guard_condition") == [guard.pointer])


def main() -> None:
    """Print it all."""
    rclpy.init()
    node = rclpy.create_node("n")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    around_every_kind(node, executor)
    occupied_group(node, executor)
    the_base_class()
    executor.remove_node(node)
    own_executor(node)
    wait_sets(node)
    rclpy.shutdown()

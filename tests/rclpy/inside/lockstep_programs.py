"""Programs of lockstep runs; each can be called in a process of its own."""

from __future__ import annotations

import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile
from rmw_local.virtual_time import START
from std_msgs.msg import String

LATCHED = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
Log = list[tuple[float, Any]]
"""Seconds of virtual time, and what happened."""


def now() -> float:
    return (time.time_ns() - START) / 1e9


def spin(make: Callable[[], Node]) -> None:
    rclpy.init()
    rclpy.spin(make())


def together(*makes: Callable[[], Node], last: Callable[[], Any]) -> Any:
    """All in one process, each node in an executor and a thread of its own."""
    rclpy.init()
    for make in makes:
        executor = SingleThreadedExecutor()
        executor.add_node(make())
        threading.Thread(target=executor.spin, daemon=True).start()
    return last()


# Three talkers at the same moments


def talker(name: str, period: float) -> Node:
    node = rclpy.create_node(name)
    publisher = node.create_publisher(String, "chatter", 10)
    count = iter(range(1000))

    def talk() -> None:
        for _ in range(2):
            publisher.publish(String(data=f"{name} {next(count)}"))

    publisher.publish(String(data=f"{name} begins"))
    node.create_timer(period, talk)
    return node


def listen(seconds: float) -> Log:
    rclpy.init()
    return heard_until(seconds)


def heard_until(seconds: float) -> Log:
    node = rclpy.create_node("listener")
    log: Log = []
    node.create_subscription(String, "chatter", lambda message: log.append((now(), message.data)), 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while (left := seconds - time.monotonic()) > 0:
        executor.spin_once(timeout_sec=left)
    return log


# Whatever a node can offer, and somebody who uses it


def provider() -> Node:
    node = rclpy.create_node("provider", parameter_overrides=[Parameter("gain", value=0.1)])
    node.declare_parameter("gain", 0.0)

    def add(request: Any, response: Any) -> Any:
        time.sleep(0.5)
        response.sum = request.a + request.b
        return response

    def execute(goal: Any) -> Any:
        for order in range(goal.request.order):
            goal.publish_feedback(Fibonacci.Feedback(sequence=[order]))
            time.sleep(0.25)
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1, 1])

    node.create_service(AddTwoInts, "add", add)
    node.action = ActionServer(node, Fibonacci, "fibonacci", execute)  # type: ignore[attr-defined]
    latched = node.create_publisher(String, "latched", LATCHED)
    for text in ("old", "older" * 100_000):
        latched.publish(String(data=text))
    return node


def use() -> Log:
    rclpy.init()
    return used()


def used() -> Log:
    node = rclpy.create_node("user")
    log: Log = []

    def note(what: Any) -> None:
        log.append((now(), what))

    adder = node.create_client(AddTwoInts, "add")
    assert adder.wait_for_service(10.0)
    time.sleep(1.0)
    node.create_subscription(String, "latched", lambda message: note("volatile, too late"), 10)
    time.sleep(0.5)
    for number in (1, 2):
        node.create_subscription(
            String,
            "latched",
            lambda message, number=number: note((number, message.data[:5], len(message.data))),
            LATCHED,
        )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    finished = partial(_finished, executor)
    note(finished(adder.call_async(AddTwoInts.Request(a=40, b=2))).sum)
    parameters = AsyncParameterClient(node, "provider")
    assert parameters.wait_for_services(10.0)
    note(finished(parameters.get_parameters(["gain"])).values[0].double_value)
    client = ActionClient(node, Fibonacci, "fibonacci")
    assert client.wait_for_server(10.0)
    goal = client.send_goal_async(
        Fibonacci.Goal(order=2), feedback_callback=lambda message: note(list(message.feedback.sequence))
    )
    note(list(finished(finished(goal).get_result_async()).result.sequence))
    note(sorted(name for name in node.get_node_names() if not name.startswith("_")))
    return log


def _finished(executor: SingleThreadedExecutor, future: Any) -> Any:
    executor.spin_until_future_complete(future)
    return future.result()


# Programs that fail, and one that waits for nobody


def sleep() -> str:
    time.sleep(360.0)
    return "slept"


def wait_for_ever() -> None:
    threading.Event().wait()


def fail() -> None:
    time.sleep(0.1)
    raise ValueError("no such joint")


def leave() -> None:
    sys.exit(3)


def be_killed() -> None:
    time.sleep(12.0)
    os.kill(os.getpid(), signal.SIGKILL)


def hang() -> None:
    here, _there = socket.socketpair()
    here.recv(1)


def say_goodbye(path: str) -> None:
    try:
        while True:
            time.sleep(0.1)
    except KeyboardInterrupt:
        with open(path, "w") as file:  # noqa: PTH123
            file.write(f"interrupted at {time.monotonic():.1f} s")

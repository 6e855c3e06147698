"""Contexts, init and shutdown in every order, and the calls that are refused afterwards."""

from __future__ import annotations

import gc
import os
import time
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.utilities import get_default_context, remove_ros_args, timeout_sec_to_nsec
from std_msgs.msg import String
from transcript import attempt


def life() -> None:
    attempt("node before init", lambda: rclpy.create_node("n"))
    attempt("shutdown before init", rclpy.shutdown)
    attempt("try_shutdown before init", rclpy.try_shutdown)
    attempt("ok", rclpy.ok)
    attempt("domain before init", lambda: Context().get_domain_id())
    attempt("handle before init", lambda: Context().handle)
    attempt("negative domain", lambda: rclpy.init(domain_id=-1))
    rclpy.init()  # newer ROS returns something
    attempt("init twice", rclpy.init)
    default = get_default_context()
    print(default is get_default_context(), default.ok(), type(default.handle).__name__)
    attempt("shutdown", rclpy.shutdown)
    print(default.ok(), default is get_default_context(), rclpy.ok())
    attempt("shutdown twice", rclpy.shutdown)
    attempt("shutdown of that context", default.shutdown)
    attempt("try_shutdown of it", default.try_shutdown)
    attempt("init of it", default.init)
    rclpy.init(args=["program", "--ros-args", "--log-level", "warn"], domain_id=5)
    print(get_default_context().get_domain_id())
    attempt("shutdown", lambda: rclpy.shutdown(context=get_default_context()))
    print(rclpy.ok(), get_default_context().ok())
    rclpy.try_shutdown()
    with Context() as context:
        print(context.ok(), rclpy.ok(), rclpy.ok(context=context))
    print(context.ok())
    attempt("enter again", context.__enter__)
    for arguments in (["--ros-args", "--nope"], ["--ros-args", "-r", "bad"], ["a", "--ros-args", "-p", "x"]):
        attempt(str(arguments), lambda: Context().init(arguments))
    print(remove_ros_args(["p", "--ros-args", "-r", "a:=b", "--", "mine"]), timeout_sec_to_nsec(0.5))
    print(timeout_sec_to_nsec(None), timeout_sec_to_nsec(-3), timeout_sec_to_nsec(0))


class Owner:
    """Has a bound method to be called at shutdown."""

    def __init__(self, seen: list[str], name: str) -> None:
        self.seen, self.name = seen, name

    def end(self) -> None:
        self.seen.append(self.name)


def shutdown_callbacks() -> None:
    seen: list[str] = []
    context, kept, dropped = Context(), Owner(seen, "kept"), Owner(seen, "dropped")
    context.on_shutdown(lambda: seen.append("before init"))
    context.init()
    context.on_shutdown(lambda: seen.append("function"))
    context.on_shutdown(kept.end)
    context.on_shutdown(dropped.end)
    del dropped
    gc.collect()
    attempt("not callable", lambda: context.on_shutdown(3))
    context.shutdown()
    context.on_shutdown(lambda: seen.append("too late"))
    print(seen)


def after_shutdown() -> None:
    rclpy.init()
    node = rclpy.create_node("n")
    publisher, guard = node.create_publisher(String, "t", 1), node.create_guard_condition(print)
    timer, client_executor = node.create_timer(1, print), SingleThreadedExecutor()
    rclpy.shutdown()
    attempt("publish", lambda: publisher.publish(String()))
    attempt("node", lambda: rclpy.create_node("m"))
    attempt("timer", lambda: node.create_timer(1, print))
    attempt("publisher", lambda: bool(node.create_publisher(String, "u", 1)))
    attempt("trigger", guard.trigger)
    attempt("timer ready", timer.is_ready)
    attempt("spin_once", lambda: client_executor.spin_once(timeout_sec=0.1))
    attempt("sleep", lambda: node.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.01)))
    attempt("destroy", node.destroy_node)
    attempt("destroy", node.destroy_node)
    attempt("publish", lambda: publisher.publish(String()))
    attempt("enter", publisher.handle.__enter__)
    attempt("pointer", lambda: publisher.handle.pointer)
    attempt("trigger", guard.trigger)
    attempt("timer", timer.is_ready)


def handles() -> None:
    context = Context()
    context.init()
    guard = _rclpy.GuardCondition(context.handle)
    with guard:
        with guard:
            guard.destroy_when_not_in_use()
            attempt("enter", guard.__enter__)
            attempt("used", guard.trigger_guard_condition)
        attempt("used", guard.trigger_guard_condition)
    attempt("unused", guard.trigger_guard_condition)
    attempt("too often", lambda: guard.__exit__(None, None, None))
    print(guard.pointer, guard.destroy_when_not_in_use())
    context.destroy()
    attempt("ok", lambda: context.handle.ok())
    attempt("shutdown", context.shutdown)


def two_contexts() -> None:
    contexts: list[Any] = [Context(), Context()]
    for context in contexts:
        rclpy.init(context=context)
    nodes = [rclpy.create_node(f"n{i}", context=context) for i, context in enumerate(contexts)]
    executors = [SingleThreadedExecutor(context=context) for context in contexts]
    for node, executor in zip(nodes, executors):
        executor.add_node(node)
    got: list[str] = []
    subscription = nodes[1].create_subscription(String, "t", lambda m: got.append(m.data), 10)
    publisher = nodes[0].create_publisher(String, "t", 10)
    end = time.monotonic() + 10
    while publisher.get_subscription_count() == 0 and time.monotonic() < end:
        time.sleep(0.05)
    publisher.publish(String(data="across"))
    while not got and time.monotonic() < end:
        executors[1].spin_once(timeout_sec=0.1)
    print(got, subscription.topic_name, rclpy.ok())
    rclpy.shutdown(context=contexts[0])
    print([context.ok() for context in contexts])
    attempt("first", lambda: executors[0].spin_once(timeout_sec=0))
    attempt("second", lambda: executors[1].spin_once(timeout_sec=0))
    contexts[1].shutdown()


def domains() -> None:
    """ROS_DOMAIN_ID is parsed as C parses a number."""
    before = os.environ["ROS_DOMAIN_ID"]
    for text in (
        "0x10",
        "010",
        "08",
        " 7",
        "7.5",
        "5x",
        "+3",
        "-1",
        "-2",
        "42\r",
        "0 ",
        "0x",
        "abc",
        "9" * 30,
    ):
        os.environ["ROS_DOMAIN_ID"] = text
        context = Context()
        attempt(f"domain {text!r}", lambda: (context.init(), context.get_domain_id()))
        context.try_shutdown()
    os.environ["ROS_DOMAIN_ID"] = before


def looked_at() -> None:
    """Names that programs look at though they are private."""
    with Context() as context:
        node = rclpy.create_node("looked_at", context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        executor.create_task(print, "a task")
        print(executor._is_shutdown, len(executor._tasks), node in executor._nodes)
        executor.spin_once(timeout_sec=5.0)
        executor.spin_once(timeout_sec=0)
        print(executor._is_shutdown, len(executor._tasks))
        before = len(node._on_set_parameters_callbacks)
        node.add_on_set_parameters_callback(print)
        print(len(node._on_set_parameters_callbacks) - before, "use_sim_time" in node._parameters)
        print(node._allow_undeclared_parameters, node._descriptors["use_sim_time"].name)
        executor.shutdown()
        print(executor._is_shutdown, len(executor._nodes))
        node.destroy_node()


def main() -> None:
    """Print it all."""
    life()
    shutdown_callbacks()
    after_shutdown()
    handles()
    two_contexts()
    domains()
    looked_at()

"""Log lines, levels, filters by calling line, /rosout and the logger services."""

from __future__ import annotations

import gc
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
from rcl_interfaces.msg import Log, LoggerLevel
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy import logging
from rclpy.clock import Clock, ROSClock
from rclpy.clock_type import ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.impl.rcutils_logger import CallerId, get_filters_from_kwargs
from rclpy.logging import get_logger
from rclpy.qos import QoSProfile
from rclpy.time import Time
from transcript import attempt, until, without_source


@contextmanager
def printing_stderr() -> Iterator[None]:
    """Print what the block writes to file descriptor 2, with times masked."""
    saved = os.dup(2)
    with tempfile.TemporaryFile("w+") as file:
        os.dup2(file.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(saved, 2)
            os.close(saved)
        file.seek(0)
        print("stderr:", re.sub(r"\d{10}\.\d{9}", "TIME", file.read()))


def lines() -> None:
    logger = get_logger("a.b")
    with printing_stderr():
        print(
            logger.debug("m {name}\nn"), logger.info("m {name}\nn"), logger.warn("m %s"), logger.warning("m")
        )
        print(logger.error("m"), logger.fatal("m"))
        print(
            logger.log("m", LoggingSeverity.INFO, name="other"), logger.log("m", 30), get_logger("a").info("")
        )
    logger.set_level(LoggingSeverity.ERROR)
    with printing_stderr():
        print(logger.info("no"), logger.error("yes"), logger.info(3), logger.info("no", nonsense=1))
        print(logger.get_child("c").info("no"), get_logger("a").info("yes"), get_logger("a.bc").info("yes"))
    for label, call in {
        "number": lambda: get_logger("x").info(3),
        "severity": lambda: logger.log("m", 33),
        "severity name": lambda: logger.log("m", "INFO"),
        "empty": lambda: get_logger(""),
        "empty child": lambda: logger.get_child(""),
        "level": lambda: logger.set_level(3),
        "level name": lambda: logger.set_level("INFO"),
        "set": lambda: logging.set_logger_level("x", 77),
        "enabled": lambda: (logger.is_enabled_for(30), logger.is_enabled_for(40)),
        "effective": lambda: (logger.get_effective_level(), logger.get_child("k").get_effective_level()),
        "levels": lambda: (logging.get_logger_level("a.b"), logging.get_logger_level("none"), logger.name),
        "inherited": lambda: logging.get_logger_effective_level("a.b.c.d"),
        "from string": lambda: logging.get_logging_severity_from_string("WaRn"),
        "from nothing": lambda: logging.get_logging_severity_from_string("nope"),
        "children": lambda: (logger.get_child("k").name, logger.get_child("k.l").name),
    }.items():
        message = attempt(label, call) if label != "number" else None
        del message
    try:
        get_logger("x").info(3)
    except TypeError:
        print("number: TypeError")
    logging.set_logger_level("", LoggingSeverity.WARN)
    print(logging.get_logger_effective_level("z"), get_logger("z").info("no"), logging.get_logger_level(""))
    logging.set_logger_level("a.b", LoggingSeverity.UNSET)
    print(logging.get_logger_effective_level("a.b"))
    logging.clear_config()
    print(logging.get_logger_effective_level("z"), logging.get_logging_directory().name)


def log(logger: Any, severity: int = 20, message: str = "m", **options: Any) -> bool:
    return logger.log(message, severity, **options)


def filters() -> None:
    logger = get_logger("f")
    with printing_stderr():
        print([logger.info("once", once=True) for _ in range(3)])
        print([logger.info("skip", skip_first=True) for _ in range(3)])
        print([logger.info("both", skip_first=True, once=True) for _ in range(4)])
        print([logger.info("throttle", throttle_duration_sec=1000) for _ in range(3)])
        print([logger.info("no throttle", throttle_duration_sec=0) for _ in range(2)])
        print([logger.info("a", once=True) or logger.info("b", once=True) for _ in range(2)])
        print(logger.info("off", once=False), logger.info("off", once=None))
        print([each.info("per logger", once=True) for each in (logger, get_logger("f"), logger)])
        clock = ROSClock()
        clock._set_ros_time_is_active(True)
        for seconds in (10, 11, 12, 12.5, 20):
            clock.set_ros_time_override(Time(seconds=seconds, clock_type=ClockType.ROS_TIME))
            print(seconds, logger.info("by clock", throttle_duration_sec=2, throttle_time_source_type=clock))
    attempt("first", lambda: log(logger, once=True))
    attempt("other filter", lambda: log(logger, skip_first=True))
    attempt("no filter", lambda: log(logger))
    attempt("other severity", lambda: log(logger, 30, once=True))
    attempt("other name", lambda: log(logger, name="other", once=True))
    attempt("below the level", lambda: log(logger, 10))
    attempt("other message", lambda: log(logger, message="other", once=True))
    attempt("other logger", lambda: log(get_logger("g")))

    def throttled(seconds: float) -> bool:
        return logger.info("t", throttle_duration_sec=seconds)

    attempt("throttle", lambda: throttled(1))
    attempt("other duration", lambda: throttled(2))
    attempt("unknown", lambda: logger.info("m", foo=1))
    attempt("missing", lambda: logger.info("m", throttle_time_source_type=Clock()))
    attempt("no clock", lambda: logger.info("m", throttle_duration_sec=1, throttle_time_source_type="STEADY"))
    attempt("filters", lambda: get_filters_from_kwargs(once=True, throttle_duration_sec=1, skip_first=False))
    caller = CallerId()
    print(
        caller.function_name, os.path.basename(caller.file_path), caller.line_number > 0, caller == CallerId()
    )


def rosout(executor: Any) -> None:
    listener = rclpy.create_node("listener", enable_rosout=False)
    executor.add_node(listener)
    got: list[Any] = []
    subscription = listener.create_subscription(Log, "/rosout", got.append, QoSProfile(depth=100))
    node = rclpy.create_node("n", namespace="/s")
    until(
        lambda: listener.count_publishers("/rosout") == 1 and subscription.get_publisher_count() == 1,
        executor,
    )
    logger = node.get_logger()
    child = logger.get_child("child")

    def show(count: int) -> None:
        until(lambda: len(got) >= count, executor, seconds=5)
        for message in got:
            where = (os.path.basename(message.file), message.function, message.line > 0)
            print(message.level, message.name, repr(message.msg), where, message.stamp.sec > 10**9)
        got.clear()

    logger.info("of the node")
    child.warning("of its child")
    child.get_child("grand").error("of its grandchild")
    get_logger("s.n").fatal("by name")
    get_logger("free").info("not seen")
    logger.debug("below the level")
    listener.get_logger().info("not seen either")
    show(4)
    again = logger.get_child("child")
    del child
    gc.collect()
    again.info("still there")
    del again
    gc.collect()
    get_logger("s.n.child").info("gone")
    logger.info("end")
    show(2)
    print(logger.name, listener.get_logger().name)
    node.destroy_node()
    logger.info("after the node's end")
    executor.remove_node(listener)
    listener.destroy_node()


def services(executor: Any) -> None:
    node = rclpy.create_node("served", enable_logger_service=True)
    executor.add_node(node)
    getter = node.create_client(GetLoggerLevels, "/served/get_logger_levels")
    setter = node.create_client(SetLoggerLevels, "/served/set_logger_levels")
    print(getter.wait_for_service(5), setter.wait_for_service(5))

    def call(client: Any, request: Any) -> Any:
        future = client.call_async(request)
        executor.spin_until_future_complete(future, 5)
        return future.result()

    levels = [
        LoggerLevel(name=name, level=level)
        for name, level in (("served", 10), ("x.y", 40), ("z", 33), ("", 30))
    ]
    for result in call(setter, SetLoggerLevels.Request(levels=levels)).results:
        print(result.successful, without_source(result.reason))
    for level in call(getter, GetLoggerLevels.Request(names=["served", "x.y", "x", "z", ""])).levels:
        print(level)
    print(node.get_logger().get_effective_level(), logging.get_logger_effective_level("x.y.z"))
    logging.set_logger_level("", 20)
    node.destroy_node()


def main() -> None:
    """Print it all."""
    lines()
    filters()
    rclpy.init()
    executor = SingleThreadedExecutor()
    with printing_stderr():
        rosout(executor)
    services(executor)
    rclpy.shutdown()
    context = rclpy.Context()
    context.init(["p", "--ros-args", "--log-level", "warn", "--log-level", "mine:=debug"])
    print(logging.get_logger_effective_level("x"), logging.get_logger_effective_level("mine.too"))
    context.shutdown()

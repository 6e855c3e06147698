"""Topics whose two ends have different definitions, and nodes that warn, as they do by default."""

from __future__ import annotations

import gc
from collections.abc import Callable

import rclpy
from ifgen.dynamic import class_from_text
from ifgen_runtime.codec import serialize
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import Mismatch
from rclpy.node import Node

from tests.rclpy.inside.mismatched_topics.speeds import (
    LATCHED,
    SPEED,
    Longer,
    Message,
    New,
    Old,
    count,
    node,
    spin,
)


def test_messages_flow_as_in_ros_and_one_warning_says_so(
    heard: list[Mismatch], log: Callable[[], list[str]]
) -> None:
    receiver, got = node("receiver", namespace="/robot"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, 10)
    publisher = node("sender").create_publisher(Longer, "/robot/speed", 10)
    for _ in range(3):
        publisher.publish(Longer(value=0.1, source="wheel"))
    spin(receiver)
    assert got == [New(value=0.1, source="wheel")] * 3
    assert [type(message) for message in got] == [New] * 3
    warnings = log()
    assert count(warnings, "[robot.receiver]: topic '/robot/speed': /sender (publisher)") == 1
    assert count(warnings, New.__type_hash__[:16]) == count(warnings, Longer.__type_hash__[:16]) == 1
    assert len(warnings) == 2  # and the bytes that are left over
    (mismatch,) = heard
    assert (mismatch.kind, mismatch.name, mismatch.type_name) == ("topic", "/robot/speed", SPEED)
    assert (mismatch.policy, mismatch.mine.role, mismatch.theirs.role) == (
        "warn",
        "subscription",
        "publisher",
    )
    assert mismatch.mine.definition is not None
    assert mismatch.theirs.definition is not None


def test_whoever_comes_last_the_warning_is_the_receivers(log: Callable[[], list[str]]) -> None:
    node("sender").create_publisher(Old, "speed", 10)
    node("receiver").create_subscription(New, "speed", print, 10)
    assert count(log(), "[receiver]: topic '/speed'") == 1


def test_equal_definitions_in_two_classes_say_nothing(
    heard: list[Mismatch], log: Callable[[], list[str]]
) -> None:
    same = class_from_text(SPEED, "float64 value\nstring source\nuint8 SAME=1")
    receiver, got = node("receiver", "refuse"), list[Message]()
    receiver.create_subscription(same, "speed", got.append, 10)
    publisher = node("sender").create_publisher(New, "speed", 10)
    publisher.publish(New(value=0.1))
    spin(receiver)
    assert same is not New
    assert got == [same(value=0.1)]
    assert heard == []
    assert log() == []


def test_bytes_that_are_left_over_are_said_once_and_counted(log: Callable[[], list[str]]) -> None:
    receiver = node("receiver")
    subscription = receiver.create_subscription(New, "speed", lambda _: None, 10)
    publisher = node("sender").create_publisher(Longer, "speed", 10)
    log()
    for _ in range(3):
        publisher.publish(Longer(source="wheel", rest=[1]))
    (*_, origin), *_ = subscription.handle.reader._queue
    spin(receiver)
    (line,) = log()
    assert (
        "topic '/speed': 7 bytes of a message of /sender were left over after demo_msgs/msg/Speed. The message was delivered"
        in line
    )
    assert origin.counts == {"left over": 3}


def test_messages_that_do_not_fit_are_said_once_and_counted(log: Callable[[], list[str]]) -> None:
    receiver, got = node("receiver"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, 10)
    publishers = [node(f"sender{i}").create_publisher(Old, "speed", 10) for i in range(2)]
    log()
    for publisher in publishers * 2:
        publisher.publish(Old(value=0.1))
    spin(receiver)
    assert got == []
    warnings = log()
    assert [count(warnings, f"A message of /sender{i} does not fit") for i in range(2)] == [1, 1]
    assert len(warnings) == 2


def test_published_bytes_are_looked_at_too(log: Callable[[], list[str]]) -> None:
    receiver, got = node("receiver"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, LATCHED)
    publisher = node("sender").create_publisher(New, "speed", LATCHED)
    publisher.publish(New(value=0.1))
    publisher.publish(serialize(New(value=0.2)))
    publisher.publish(serialize(Longer(value=0.3, rest=[1, 2])))
    publisher.publish(serialize(New(value=0.4)) + bytes(3))  # padded, as DDS does
    spin(receiver)
    assert [message.value for message in got] == [0.1, 0.2, 0.3, 0.4]
    (line,) = log()
    assert "bytes of a message of /sender were left over after" in line
    assert "It publishes bytes" in line
    late = node("late")
    late.create_subscription(New, "speed", got.append, LATCHED)
    spin(late)
    assert [message.value for message in got[4:]] == [0.1, 0.2, 0.3, 0.4]
    publisher.publish(b"\0\1\0\0")
    spin(late)
    spin(receiver)
    (line,) = log()
    assert "A message of /sender does not fit demo_msgs/msg/Speed" in line


def test_nested_definitions_that_differ() -> None:
    nested = [f"MSG: demo_msgs/Point\nfloat64 x\n{more}" for more in ("", "float64 y")]
    first, second = (
        class_from_text("demo_msgs/msg/Goal", f"Point at\n{'=' * 80}\n{text}") for text in nested
    )
    receiver, got = node("receiver", "refuse"), list[Message]()
    receiver.create_subscription(first, "goal", got.append, 10)
    node("sender").create_publisher(second, "goal", 10).publish(second())
    spin(receiver)
    assert got == []


def test_types_of_different_names_stay_apart(heard: list[Mismatch]) -> None:
    other = class_from_text("demo_msgs/msg/Pace", "float32 value")
    context = rclpy.Context()
    rclpy.init(context=context)
    receiver = node("receiver", "refuse")
    subscription = receiver.create_subscription(New, "speed", print, 10)
    Node("sender", context=context).create_publisher(other, "speed", 10)
    assert subscription.get_publisher_count() == 0
    assert heard == []
    rclpy.shutdown(context=context)


def test_remapped_names(log: Callable[[], list[str]]) -> None:
    receiver = node("receiver", cli_args=["--ros-args", "-r", "speed:=/fast"])
    receiver.create_subscription(New, "speed", print, 10)
    node("sender").create_publisher(Old, "/fast", 10)
    assert count(log(), "topic '/fast'") == 1


def test_nodes_that_come_and_go_by_the_thousand_fill_neither_log_nor_memory(
    heard: list[Mismatch], log: Callable[[], list[str]]
) -> None:
    receiver = node("receiver")
    reader = receiver.create_subscription(New, "speed", print, 10).handle.reader
    sender = node("sender")
    for _ in range(1000):
        publisher = sender.create_publisher(Old, "speed", 10)
        sender.destroy_publisher(publisher)
    assert len(heard) == 1000
    warnings = log()
    assert len(warnings) == reporting.WARNINGS + 1
    assert "which is not said any more" in warnings[-1]
    for index in range(1000):
        names = f"speed{index}"
        ends = (receiver.create_subscription(New, names, print, 1), sender.create_publisher(Old, names, 1))
        receiver.destroy_subscription(ends[0])
        sender.destroy_publisher(ends[1])
    assert len(log()) == reporting.NAMES - 1 + reporting.WARNINGS + 1
    assert len(reader.node.participant.warning_limit._counts) == reporting.NAMES + 1
    gc.collect()
    assert reader.encounters == ()

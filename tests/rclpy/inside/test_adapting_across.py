"""Subscriptions that adapt what processes with another version of a type publish."""

from __future__ import annotations

from typing import Any

import pytest
from ifgen.dynamic import class_from_text
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.mismatch.reporting import Mismatch
from rclpy.node import Node

from tests.rclpy.inside.contract.processes import DURABLE, Pair

POINT = "demo_msgs/msg/Point"
OldPoint = class_from_text(POINT, "float32 x")
NewPoint = class_from_text(POINT, "float32 depth\nfloat32 x")
OtherPoint = class_from_text(POINT, "string x")


@pytest.fixture(autouse=True)
def adapter(no_adapters: None, heard: list[Mismatch]) -> None:
    register(Adapter(OldPoint, NewPoint, lambda old: NewPoint(x=old.x, depth=0.1)))


@pytest.fixture
def pair(across: Pair) -> Pair:
    return across


def adapting(pair: Pair, name: str) -> Node:
    node = pair.process(name).node
    node.handle.graph_node.on_type_mismatch = "adapt"
    return node


def values(received: list[Any]) -> list[tuple[float, float]]:
    return [(round(each.x, 6), round(each.depth, 6)) for each in received]


@pytest.mark.parametrize("publisher_first", [True, False])
def test_messages_arrive_converted(pair: Pair, heard: list[Mismatch], publisher_first: bool) -> None:
    one, other = pair.process("one").node, adapting(pair, "two")
    received: list[Any] = []
    publisher = one.create_publisher(OldPoint, "point", 10) if publisher_first else None
    other.create_subscription(NewPoint, "point", received.append, 10)
    publisher = publisher or one.create_publisher(OldPoint, "point", 10)
    pair.until(lambda: publisher.get_subscription_count() == 1)
    for x in (0.1, -2.5):
        publisher.publish(OldPoint(x=x))
    pair.until(lambda: len(received) == 2)
    assert values(received) == [(0.1, 0.1), (-2.5, 0.1)]
    assert all(type(each) is NewPoint for each in received)
    pair.until(lambda: len(heard) == 2)
    assert {(each.mine.role, each.policy) for each in heard} == {
        ("subscription", "adapt"),
        ("publisher", "refuse"),
    }


def test_late_subscriptions_get_what_was_kept(pair: Pair) -> None:
    one, other = pair.process("one").node, adapting(pair, "two")
    publisher = one.create_publisher(OldPoint, "point", DURABLE)
    for x in (0.1, 0.2):
        publisher.publish(OldPoint(x=x))
    received: list[Any] = []
    other.create_subscription(NewPoint, "point", received.append, DURABLE)
    pair.until(lambda: len(received) == 2)
    publisher.publish(OldPoint(x=0.3))
    pair.until(lambda: len(received) == 3)
    assert values(received) == [(x, 0.1) for x in (0.1, 0.2, 0.3)]


def test_the_graph_counts_a_subscription_that_adapts_once(pair: Pair, heard: list[Mismatch]) -> None:
    one, other, third = pair.process("one").node, adapting(pair, "two"), pair.process("three").node
    received: list[Any] = []
    old = one.create_publisher(OldPoint, "point", 10)
    new = third.create_publisher(NewPoint, "point", 10)
    other.create_subscription(NewPoint, "point", received.append, 10)
    pair.until(lambda: old.get_subscription_count() == new.get_subscription_count() == 1)
    pair.until(lambda: len(heard) == 2)
    pair.settle()
    assert one.count_subscribers("point") == third.count_subscribers("point") == 1
    assert len(one.get_subscriptions_info_by_topic("point")) == 1
    old.publish(OldPoint(x=1.5))
    new.publish(NewPoint(x=2.5, depth=3.5))
    pair.until(lambda: len(received) == 2)
    assert sorted(values(received)) == [(1.5, 0.1), (2.5, 3.5)]
    pair.settle()
    assert len(received) == len(heard) == 2


def test_it_ends_with_its_subscription(pair: Pair) -> None:
    one, other = pair.process("one").node, adapting(pair, "two")
    publisher = one.create_publisher(OldPoint, "point", 10)
    subscription = other.create_subscription(NewPoint, "point", print, 10)
    pair.until(lambda: publisher.get_subscription_count() == 1)
    other.destroy_subscription(subscription)
    pair.until(lambda: publisher.get_subscription_count() == 0)
    publisher.publish(OldPoint())
    pair.settle()


def test_a_publisher_that_comes_later_is_adapted_as_well(pair: Pair) -> None:
    one, other, third = pair.process("one").node, adapting(pair, "two"), pair.process("three").node
    received: list[Any] = []
    first = one.create_publisher(OldPoint, "point", DURABLE)
    other.create_subscription(NewPoint, "point", received.append, DURABLE)
    pair.until(lambda: first.get_subscription_count() == 1)
    one.destroy_publisher(first)
    second = third.create_publisher(OldPoint, "point", DURABLE)
    second.publish(OldPoint(x=0.1))
    pair.until(lambda: received)
    assert values(received) == [(0.1, 0.1)]


def test_without_an_adapter_it_refuses_and_says_so(
    pair: Pair, heard: list[Mismatch], capfd: pytest.CaptureFixture[str]
) -> None:
    one, other = pair.process("one").node, adapting(pair, "two")
    received: list[Any] = []
    publisher = one.create_publisher(OtherPoint, "point", 10)
    other.create_subscription(NewPoint, "point", received.append, 10)
    pair.until(lambda: len(heard) == 2)
    publisher.publish(OtherPoint(x="not a number"))
    log: list[str] = []
    pair.until(lambda: log.append(capfd.readouterr().err) or "no adapter was registered" in "".join(log))
    pair.settle()
    assert not received
    assert {each.policy for each in heard} == {"refuse"}


def test_bytes_and_adapters_that_fail_are_dropped_and_said_once(
    recorded: Pair, capfd: pytest.CaptureFixture[str]
) -> None:
    one, other = recorded.process("one").node, adapting(recorded, "two")
    register(Adapter(OldPoint, NewPoint, lambda old: NewPoint(x=1.0 / old.x)))
    received: list[Any] = []
    publisher = one.create_publisher(OldPoint, "point", 10)
    other.create_subscription(NewPoint, "point", received.append, 10)
    recorded.until(lambda: publisher.get_subscription_count() == 1)
    for _ in range(2):
        publisher.publish(b"\0\1\0\0\0")
        publisher.publish(OldPoint(x=0.0))
    publisher.publish(OldPoint(x=2.0))
    recorded.until(lambda: received)
    assert values(received) == [(0.5, 0.0)]
    log = capfd.readouterr().err
    assert log.count("does not fit demo_msgs/msg/Point") == 1
    assert log.count("ZeroDivisionError") == 1


def test_whoever_warns_gets_nothing(recorded: Pair, heard: list[Mismatch]) -> None:
    one, other = recorded.process("one").node, recorded.process("two").node
    received: list[Any] = []
    publisher = one.create_publisher(OldPoint, "point", 10)
    other.create_subscription(NewPoint, "point", received.append, 10)
    recorded.until(lambda: len(heard) == 2)
    publisher.publish(OldPoint())
    recorded.settle()
    assert publisher.get_subscription_count() == 0
    assert not received

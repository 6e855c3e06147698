"""Topics whose two ends have different definitions, and nodes that refuse them."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from ifgen_runtime.mismatch.reporting import Mismatch
from rclpy.event_handler import SubscriptionEventCallbacks

from tests.rclpy.inside.mismatched_topics.speeds import (
    LATCHED,
    Longer,
    Message,
    New,
    Old,
    count,
    node,
    spin,
    spin_until_shutdown,
)


def test_nothing_is_delivered_while_a_mismatched_publisher_is_there(
    heard: list[Mismatch], log: Callable[[], list[str]]
) -> None:
    receiver, got, events = node("receiver", "refuse"), list[Message](), list[Any]()
    subscription = receiver.create_subscription(
        New,
        "speed",
        got.append,
        2,
        event_callbacks=SubscriptionEventCallbacks(incompatible_type=events.append),
    )
    good = node("good").create_publisher(New, "speed", 10)
    bad_node = node("bad")
    good.publish(New(value=0.1))
    bad = [bad_node.create_publisher(Old, "speed", 10) for _ in range(2)]
    for index in range(3):
        bad[0].publish(Old(value=0.5))
        good.publish(New(value=float(index)))
    spin(receiver)
    assert got == []
    assert sum(event.total_count_change for event in events) == 2
    assert subscription.get_publisher_count() == 1
    assert bad[0].get_subscription_count() == 0
    assert good.get_subscription_count() == 1
    assert [mismatch.policy for mismatch in heard] == ["refuse"] * 2
    assert count(log(), "[receiver]: topic '/speed': /bad (publisher)") == 2
    bad_node.destroy_publisher(bad[0])
    spin(receiver)
    assert got == []
    bad_node.destroy_publisher(bad[1])
    spin(receiver)
    assert [message.value for message in got] == [1.0, 2.0]  # as many as wait at most, none of the bad ones
    good.publish(New(value=0.3))
    spin(receiver)
    assert got[-1].value == 0.3


def test_an_executor_that_waits_hears_of_the_end(log: Callable[[], list[str]]) -> None:
    receiver, came = node("receiver", "refuse"), threading.Event()
    receiver.create_subscription(New, "speed", lambda _: came.set(), 10)
    bad_node = node("bad")
    bad_node.create_publisher(Old, "speed", 10)
    node("good").create_publisher(New, "speed", 10).publish(New())
    thread = threading.Thread(target=spin_until_shutdown, args=(receiver,))
    thread.start()
    assert not came.is_set()
    bad_node.destroy_node()
    assert came.wait(10)
    rclpy.shutdown()
    thread.join()


def test_what_durable_publishers_hold_comes_after_the_mismatched_one_has_gone() -> None:
    good = node("good").create_publisher(New, "map", LATCHED)
    good.publish(New(value=0.1))
    bad_node = node("bad")
    bad = bad_node.create_publisher(Old, "map", LATCHED)
    bad.publish(Old(value=0.5))
    receiver, got = node("receiver", "refuse"), list[Message]()
    receiver.create_subscription(New, "map", got.append, LATCHED)
    good.publish(New(value=0.2))
    spin(receiver)
    assert got == []
    bad_node.destroy_publisher(bad)
    spin(receiver)
    assert [message.value for message in got] == [0.1, 0.2]


def test_another_subscription_of_another_node_is_not_concerned() -> None:
    strict, lax, got = node("strict", "refuse"), node("lax"), list[Message]()
    strict.create_subscription(New, "speed", lambda _: pytest.fail("refused"), 10)
    lax.create_subscription(New, "speed", got.append, 10)
    node("bad").create_publisher(Longer, "speed", 10).publish(Longer())
    node("good").create_publisher(New, "speed", 10).publish(New())
    spin(strict)
    spin(lax)
    assert len(got) == 2


def test_a_subscription_that_goes_leaves_nothing_behind() -> None:
    receiver = node("receiver", "refuse")
    subscription = receiver.create_subscription(New, "speed", print, 10)
    publisher = node("bad").create_publisher(Old, "speed", 10)
    topic = publisher.handle.writer.node.participant.domain.topics["/speed"]
    assert len(topic._refused) == 1
    receiver.destroy_subscription(subscription)
    assert not topic._refused

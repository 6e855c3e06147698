"""When `wait_for_all_acked` says that all subscriptions have everything."""

from __future__ import annotations

from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64

from tests.rclpy.inside.contract.processes import DURABLE, Pair

LONG = Duration(seconds=30)


def test_all_have_what_was_published_before(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    ends = [other.create_subscription(Float64, "value", print, 50) for _ in range(2)]
    publisher = one.create_publisher(Float64, "value", 50)
    assert publisher.wait_for_all_acked(LONG)
    pair.until(
        lambda: publisher.get_subscription_count() == 2 and all(end.get_publisher_count() for end in ends)
    )
    for number in range(20):
        publisher.publish(Float64(data=number + 0.1))
    assert publisher.wait_for_all_acked()
    assert [end.handle.reader.unread for end in ends] == [20, 20]  # nothing has been spun yet
    other.create_subscription(Float64, "value", print, 50)  # nothing is owed to this one yet
    pair.until(lambda: publisher.get_subscription_count() == 3)
    assert publisher.wait_for_all_acked(LONG)


def test_what_is_kept_is_owed_to_those_that_come_late(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    publisher = one.create_publisher(Float64, "state", DURABLE)
    for number in range(5):
        publisher.publish(Float64(data=number + 0.1))
    assert publisher.wait_for_all_acked(LONG)
    heard: list[float] = []
    late = other.create_subscription(Float64, "state", lambda message: heard.append(message.data), DURABLE)
    volatile = QoSProfile(depth=3, durability=DurabilityPolicy.VOLATILE)
    other.create_subscription(Float64, "state", print, volatile)
    pair.until(lambda: publisher.get_subscription_count() == 2)
    assert publisher.wait_for_all_acked(LONG)
    # Zenoh may still have been on its way with an older one, to a process that had nobody for it yet.
    assert len(heard) + late.handle.reader.unread >= 3


def test_nobody_waits_for_best_effort(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    other.create_subscription(Float64, "value", print, best_effort)
    for qos in (5, best_effort):
        publisher: Any = one.create_publisher(Float64, "value", qos)
        pair.until(publisher.get_subscription_count)
        publisher.publish(Float64(data=0.1))
        assert publisher.wait_for_all_acked(Duration(seconds=0))

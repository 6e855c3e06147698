"""Messages: what is heard is what was published, in its order, as often as the depth allows."""

from __future__ import annotations

import time
from typing import Any

from rclpy.node import Node
from std_msgs.msg import Float64, String

from tests.rclpy.inside.contract.processes import LIMIT, Pair


def test_messages_pass_both_ways(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    heard: list[tuple[Any, Any]] = []
    echoes: list[float] = []
    back = other.create_publisher(Float64, "back", 10)
    other.create_subscription(
        Float64, "there", lambda m, info: (heard.append((m, info)), back.publish(m)), 10
    )
    one.create_subscription(Float64, "back", lambda message: echoes.append(message.data), 10)
    publisher = one.create_publisher(Float64, "there", 10)
    pair.until(lambda: publisher.get_subscription_count() == 1 and back.get_subscription_count() == 1)
    before = time.time_ns()
    for value in (0.1, -2.5, 1e300):
        publisher.publish(Float64(data=value))
    pair.until(lambda: len(echoes) == 3)
    assert echoes == [0.1, -2.5, 1e300]
    info = [info for _, info in heard]
    assert [each["publication_sequence_number"] for each in info] == [1, 2, 3]
    assert all(before <= each["source_timestamp"] <= each["received_timestamp"] for each in info)


def test_only_the_newest_messages_wait_for_a_slow_subscription(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    heard: list[float] = []
    other.create_subscription(Float64, "fast", lambda message: heard.append(message.data), 5)
    done: list[Any] = []
    other.create_subscription(String, "done", done.append, 5)
    publisher, last = one.create_publisher(Float64, "fast", 5), one.create_publisher(String, "done", 5)
    pair.until(lambda: publisher.get_subscription_count() and last.get_subscription_count())
    reader = next(iter(other.handle.graph_node.participant.domain.topics["/fast"].readers))
    for number in range(100):
        publisher.publish(Float64(data=float(number)))
    end = time.monotonic() + LIMIT
    while reader._queue[-1][2] != 100 if reader.unread else True:
        assert time.monotonic() < end
        time.sleep(0.001)
    pair.until(lambda: len(heard) == 5)
    assert heard == [95.0, 96.0, 97.0, 98.0, 99.0]

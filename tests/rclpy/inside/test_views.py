"""Subscriptions with views: their messages show the bytes that all subscriptions of a topic share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from ifgen_runtime.views import SequenceView
from rclpy.node import Node
from rclpy.serialization import serialize_message
from sensor_msgs.msg import Image
from std_msgs.msg import String


@pytest.fixture
def node() -> Iterator[Node]:
    """A node; rclpy is up."""
    rclpy.init()
    yield rclpy.create_node("views")
    rclpy.shutdown()


def spin_until(node: Node, received: list[Any], count: int) -> None:
    """Spin until so many messages have arrived."""
    for _ in range(3 * count):
        if len(received) < count:
            rclpy.spin_once(node, timeout_sec=1.0)
    assert len(received) == count


def test_subscriptions_share_the_bytes(node: Node) -> None:
    viewing: list[Any] = []
    raw: list[bytes] = []
    for _ in range(2):
        node.create_subscription(Image, "image", viewing.append, 10, views=True)
    node.create_subscription(Image, "image", raw.append, 10, raw=True)
    sent = Image(height=1, width=3, step=3, encoding="mono8", data=[1, 2, 3])
    node.create_publisher(Image, "image", 10).publish(sent)
    spin_until(node, viewing, 2)
    spin_until(node, raw, 1)
    first, second = viewing
    assert first == second == sent
    assert first.data.base is second.data.base is raw[0]
    first.data[0] = 9
    assert (first.data[0], second.data[0], raw[0]) == (9, 1, serialize_message(sent))


def test_views_are_published_and_counted_like_others(node: Node) -> None:
    """What a callback with views passes on arrives as it was sent."""
    publisher = node.create_publisher(Image, "out", 10)
    node.create_subscription(Image, "in", lambda image, info: publisher.publish(image), 10, views=True)
    received: list[Any] = []
    node.create_subscription(Image, "out", received.append, 10)
    sent = Image(height=1, width=3, step=3, encoding="mono8", data=[1, 2, 3])
    node.create_publisher(Image, "in", 10).publish(sent)
    for _ in range(2):
        rclpy.spin_once(node, timeout_sec=1.0)
    assert received == [sent]
    assert type(received[0].data) is not SequenceView


def test_messages_without_sequences(node: Node) -> None:
    received: list[Any] = []
    node.create_subscription(String, "text", received.append, 10, views=True)
    node.create_publisher(String, "text", 10).publish(String(data="a"))
    spin_until(node, received, 1)
    assert received == [String(data="a")]


def test_bytes_that_are_no_message_are_dropped(node: Node, capfd: pytest.CaptureFixture[str]) -> None:
    received: list[Any] = []
    node.create_subscription(Image, "image", received.append, 10, views=True)
    publisher = node.create_publisher(Image, "image", 10)
    publisher.publish(serialize_message(Image(data=[1, 2, 3]))[:-1])
    publisher.publish(Image())
    spin_until(node, received, 1)
    assert received == [Image()]
    assert "dropped" in capfd.readouterr().err


def test_raw_bytes_have_no_views(node: Node) -> None:
    with pytest.raises(ValueError, match="cannot have raw and views"):
        node.create_subscription(Image, "image", lambda _: None, 10, raw=True, views=True)  # type: ignore[call-overload]

"""Messages with large arrays: a subscription that is alone gets the publisher's copy, and nobody notices."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from ifgen_runtime.codec.choice import chosen
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image

PIXELS = bytes(range(256)) * 64


@pytest.fixture
def node() -> Iterator[Node]:
    """A node; rclpy is up."""
    rclpy.init()
    node = rclpy.create_node("large")
    yield node
    node.destroy_node()  # else the topic has its endpoints until they are collected as garbage
    rclpy.shutdown()


def image(frame: str = "camera", **options: Any) -> Image:
    message = Image(height=64, width=256, step=256, encoding="mono8", data=PIXELS, **options)
    message.header.frame_id = frame
    return message


def spin_until(node: Node, received: list[Any], count: int) -> None:
    """Spin until so many messages have arrived."""
    for _ in range(5 * count):
        if len(received) < count:
            rclpy.spin_once(node, timeout_sec=1.0)
    assert len(received) == count


def test_the_message_is_the_subscriber_s_own(node: Node) -> None:
    received: list[Image] = []
    node.create_subscription(Image, "image", received.append, 10)
    publisher, sent = node.create_publisher(Image, "image", 10), image()
    for _ in range(2):
        publisher.publish(sent)
    sent.data[0] = 99  # after it was published
    spin_until(node, received, 2)
    received[0].data[1] = 98
    received[0].data.append(97)
    assert received[1] == image()
    assert sent.data[:2].tolist() == [99, 1]


def test_subscriptions_do_not_share_arrays(node: Node) -> None:
    first: list[Image] = []
    second: list[Image] = []
    publisher = node.create_publisher(Image, "image", 10)
    node.create_subscription(Image, "image", first.append, 10)
    publisher.publish(image("to one"))
    late = node.create_subscription(Image, "image", second.append, 10)
    publisher.publish(image("to both"))
    node.destroy_subscription(late)
    publisher.publish(image("to one again"))
    spin_until(node, first, 3)
    assert [message.header.frame_id for message in first] == ["to one", "to both", "to one again"]
    assert all(message.data == image().data for message in first)


def test_each_of_two_subscriptions_has_its_own(node: Node) -> None:
    received: list[Image] = []
    for _ in range(2):
        node.create_subscription(Image, "image", received.append, 10)
    node.create_publisher(Image, "image", 10).publish(image())
    spin_until(node, received, 2)
    received[0].data[0] = 99
    assert received[1] == image()


@pytest.mark.skipif(chosen().extension is None, reason="the codec in C does not run here")
def test_only_one_that_is_alone_and_takes_messages_gets_no_bytes(node: Node) -> None:
    publisher = node.create_publisher(Image, "image", 10)

    def queued(subscription: Any) -> str:
        publisher.publish(image())
        return type(subscription.handle.reader.take()[0]).__name__

    alone = node.create_subscription(Image, "image", lambda _: None, 10)
    assert queued(alone) == "Parcel"
    viewing = node.create_subscription(Image, "image", lambda _: None, 10, views=True)
    assert (queued(alone), queued(viewing)) == ("bytes", "bytes")
    node.destroy_subscription(alone)
    assert queued(viewing) == "bytes"
    node.destroy_subscription(viewing)
    raw = node.create_subscription(Image, "image", lambda _: None, 10)
    assert queued(raw) == "Parcel"
    publisher.publish(image())
    raw.handle.take_message(Image, True)
    assert queued(raw) == "bytes"


def test_raw_subscriptions_get_bytes(node: Node) -> None:
    raw: list[bytes] = []
    node.create_subscription(Image, "image", raw.append, 10, raw=True)
    publisher = node.create_publisher(Image, "image", 10)
    for count in (1, 2, 3):
        publisher.publish(image())
        spin_until(node, raw, count)
    assert {type(each) for each in raw} == {bytes}
    assert set(raw) == {serialize_message(image())}


def test_one_that_is_taken_raw_now_and_then(node: Node) -> None:
    """With the handle, as programs for real rclpy do that take messages themselves."""
    subscription = node.create_subscription(Image, "image", lambda message: None, 10)
    publisher = node.create_publisher(Image, "image", 10)
    for _ in range(4):
        publisher.publish(image())
    with subscription.handle:
        for raw in (False, True, False, True):
            taken = subscription.handle.take_message(Image, raw)[0]
            assert (deserialize_message(taken, Image) if raw else taken) == image()


def test_late_subscriptions_get_what_was_kept(node: Node) -> None:
    qos = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(Image, "image", qos)
    received: list[Image] = []
    node.create_subscription(Image, "image", received.append, qos)
    publisher.publish(image())
    late: list[Image] = []
    node.create_subscription(Image, "image", late.append, qos)
    spin_until(node, received, 1)
    spin_until(node, late, 1)
    received[0].data[0] = 99
    assert late == [image()]


def test_an_error_names_the_field_and_nothing_is_sent(node: Node) -> None:
    received: list[Image] = []
    node.create_subscription(Image, "image", received.append, 10)
    publisher, wrong = node.create_publisher(Image, "image", 10), image()
    wrong.height = -1
    with pytest.raises(ValueError, match=r"Image\.height: expected an integer in"):
        publisher.publish(wrong)
    publisher.publish(image())
    spin_until(node, received, 1)


def test_objects_of_derived_classes_and_with_checks(node: Node) -> None:
    class Mine(Image):
        pass

    received: list[Image] = []
    node.create_subscription(Image, "image", received.append, 10)
    publisher = node.create_publisher(Image, "image", 10)
    publisher.publish(image(check_fields=True))
    publisher.publish(Mine(data=PIXELS))
    spin_until(node, received, 2)
    assert [type(message) for message in received] == [Image, Image]
    assert received == [image(), Image(data=PIXELS)]


def test_subscriptions_come_and_go_while_it_publishes(node: Node) -> None:
    """No subscription may get what was made for another one alone."""
    publisher = node.create_publisher(Image, "image", 1000)
    done = threading.Event()

    def publish() -> None:
        while not done.is_set():
            publisher.publish(image())

    thread = threading.Thread(target=publish)
    thread.start()
    received: list[Image] = []
    try:
        for _ in range(20):
            both = [node.create_subscription(Image, "image", received.append, 5) for _ in range(2)]
            for _ in range(4):
                rclpy.spin_once(node, timeout_sec=1.0)
            for subscription in both:
                node.destroy_subscription(subscription)
    finally:
        done.set()
        thread.join()
    assert received
    assert len({id(message.data) for message in received}) == len(received)
    assert all(message.data == image().data for message in received)

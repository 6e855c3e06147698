"""Definitions that differ, among lifecycle nodes, threads, virtual time, strict mode and hostile bytes."""

from __future__ import annotations

import random
import threading

import pytest
import rclpy
from ifgen.dynamic import class_from_text
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.codec import serialize
from ifgen_runtime.codec.decoding import size_of
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rmw_local import observer, virtual_time
from rmw_local.message import DecodeError, message_type
from rmw_local.mismatch.origin import Origin

from tests.rclpy.inside.mismatched_topics.speeds import (
    Longer,
    Message,
    New,
    Old,
    node,
    nodes,
    spin,
    spin_until_shutdown,
    upgrade,
)


def test_lifecycle_nodes() -> None:
    register(Adapter(Old, New, upgrade))
    sender = LifecycleNode("sender")
    nodes.append(sender)
    publisher = sender.create_lifecycle_publisher(Old, "speed", 10)
    receiver = LifecycleNode("receiver", parameter_overrides=[Parameter("on_type_mismatch", value="adapt")])
    nodes.append(receiver)
    got: list[Message] = []
    receiver.create_subscription(New, "speed", got.append, 10)
    publisher.publish(Old(value=0.1))
    sender.trigger_configure()
    sender.trigger_activate()
    publisher.publish(Old(value=0.5))
    spin(receiver)
    assert got == [New(value=0.5, source="adapted")]


def test_threads_that_come_and_go_while_others_publish() -> None:
    receiver, got = node("receiver", "refuse"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, 10)
    good = node("good").create_publisher(New, "speed", 10)
    bad_nodes, over = [node(f"bad{index}") for index in range(3)], threading.Event()

    def come_and_go(bad_node: Node) -> None:
        for _ in range(100):
            publisher = bad_node.create_publisher(Longer, "speed", 10)
            publisher.publish(Longer(source="bad"))
            bad_node.destroy_publisher(publisher)

    def publish() -> None:
        while not over.is_set():
            good.publish(New(source="good"))

    spinning = threading.Thread(target=spin_until_shutdown, args=(receiver,))
    publishing = threading.Thread(target=publish)
    coming = [threading.Thread(target=come_and_go, args=(each,)) for each in bad_nodes]
    for thread in (spinning, publishing, *coming):
        thread.start()
    for thread in coming:
        thread.join()
    over.set()
    publishing.join()
    last = len(got)
    good.publish(New(source="last"))
    while not got or got[-1].source != "last":
        assert spinning.is_alive()
    rclpy.shutdown()
    spinning.join()
    assert {message.source for message in got} == {"good", "last"}
    assert len(got) > last


def test_virtual_time_stays_the_same_each_time() -> None:
    register(Adapter(Old, New, upgrade))

    def run() -> list[tuple[float, int]]:
        got: list[tuple[float, int]] = []
        with virtual_time.virtual_time(seed=3):
            receiver, sender = node("receiver", "adapt"), node("sender")
            publisher = sender.create_publisher(Old, "speed", 10)
            receiver.create_subscription(
                New, "speed", lambda m: got.append((m.value, receiver.get_clock().now().nanoseconds)), 10
            )
            sender.create_timer(0.1, lambda: publisher.publish(Old(value=0.5)))
            executor = SingleThreadedExecutor()
            for each in (receiver, sender):
                executor.add_node(each)
            while len(got) < 3:
                executor.spin_once()
        return got

    first = run()
    assert first == run()


class Notes:
    """An observer that notes what is lost."""

    def __init__(self) -> None:
        self.lost: list[tuple[str, int, str]] = []

    def undelivered(self, topic: str, number: int, why: str) -> None:
        self.lost.append((topic, number, why))

    def incompatible_qos(self, *_: object) -> None: ...
    def opened(self, entity: object) -> None: ...
    def closed(self, entity: object) -> None: ...


def test_strict_mode_counts_what_was_dropped_or_kept_back() -> None:
    notes = Notes()
    before = observer.install(notes)
    try:
        receiver = node("receiver")
        receiver.create_subscription(New, "speed", print, 10)
        node("old").create_publisher(Old, "speed", 10).publish(Old())
        spin(receiver)
        assert ("/speed", 1, "unreadable, from /old") in notes.lost
        strict = node("strict", "refuse")
        subscription = strict.create_subscription(New, "fast", print, 1)
        node("bad").create_publisher(Old, "fast", 10)
        good = node("good").create_publisher(New, "fast", 10)
        for _ in range(2):
            good.publish(New())
        strict.destroy_subscription(subscription)
        assert [each for each in notes.lost if each[0] == "/fast"] == [
            ("/fast", 1, "overwritten before it was read"),
            ("/fast", 1, "never read"),
        ]
    finally:
        observer.install(before)


def test_whatever_the_bytes_are_reading_them_ends_well() -> None:
    part = f"{'=' * 80}\nMSG: demo_msgs/Part\nfloat32 x\nstring y"
    cls = class_from_text(
        "demo_msgs/msg/Whole",
        f"bool b\nstring s\nwstring<=3 w\nuint8[] d\nfloat64[<=3] f\nstring[] n\nPart[] p\nint16[3] a\n{part}",
    )
    kind, place, draw = message_type(cls), node("n").handle.graph_node, random.Random(1)
    origin, raw = Origin("topic", "/t", place), Origin("topic", "/t", place, is_raw=True)
    whole = serialize(
        cls(b=True, s="é", w="ab", d=[1, 2], f=[0.1], n=["", "c"], p=[cls.__nested__[0](y="y")], a=[1, 2, 3])
    )
    read = 0
    for _ in range(3000):
        data = bytearray(whole)
        for _ in range(draw.randint(1, 4)):
            data[draw.randrange(len(data))] = draw.choice((0, 1, 3, 255, draw.randrange(256)))
        data = (
            data[: draw.randint(1, len(data))]
            if draw.random() < 0.2
            else data + draw.randbytes(draw.randint(0, 5))
        )
        message = origin.read(bytes(data), kind, kind.deserialize, place)
        assert (raw.read(bytes(data), kind, kind.deserialize, place) is None) == (message is None)
        if message is not None:
            read += 1
            size = size_of(bytes(data), cls)
            assert serialize(kind.deserialize(bytes(data[:size]))) == serialize(message)
            with pytest.raises(DecodeError):
                kind.deserialize(bytes(data[: size - 1]))
    assert 0 < read < 3000
    assert origin.counts["unreadable"] == 3000 - read

"""Topics whose two ends have different definitions, and nodes that adapt them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from ifgen.dynamic import class_from_text
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.codec import serialize
from ifgen_runtime.mismatch.reporting import Mismatch

from tests.rclpy.inside.mismatched_topics.speeds import (
    LATCHED,
    SPEED,
    Message,
    New,
    Old,
    count,
    node,
    spin,
    upgrade,
)


def test_messages_of_another_version_are_converted() -> None:
    register(Adapter(Old, New, upgrade))
    receiver, got = node("receiver", "adapt"), list[Any]()
    receiver.create_subscription(New, "speed", lambda message, info: got.append((message, info)), 10)
    old, new = node("old").create_publisher(Old, "speed", 10), node("new").create_publisher(New, "speed", 10)
    old.publish(Old(value=0.5))
    new.publish(New(value=0.1))
    old.publish(Old(value=0.25))
    spin(receiver)
    assert [message for message, _ in got] == [
        New(value=0.5, source="adapted"),
        New(value=0.1),
        New(value=0.25, source="adapted"),
    ]
    assert [info["publication_sequence_number"] for _, info in got] == [1, 1, 2]
    stamps = [info["source_timestamp"] for _, info in got]
    assert stamps == sorted(stamps)


def test_an_adapter_for_a_class_of_the_same_version_will_do() -> None:
    frozen = class_from_text(SPEED, "float32 value\nuint8 FROZEN=1")
    register(Adapter(frozen, New, lambda old: New(value=old.value, source=type(old).__name__)))
    receiver, got = node("receiver", "adapt"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, 10)
    node("old").create_publisher(Old, "speed", 10).publish(Old(value=0.5))
    spin(receiver)
    assert got == [New(value=0.5, source="Speed")]


def test_an_adapter_of_the_type_of_a_field_is_enough() -> None:
    texts = ("float32 value", "float64 value\nstring source")
    old, new = (
        class_from_text(
            "demo_msgs/msg/Speeds",
            f"string name\nSpeed first\nSpeed[] more\n{'=' * 80}\nMSG: demo_msgs/Speed\n{text}",
        )
        for text in texts
    )
    part = new.__nested__[0]
    frozen = class_from_text(SPEED, f"{texts[0]}\nuint8 FROZEN=1")
    register(
        Adapter(frozen, part, lambda m: part(value=m.value, source="s"), lambda m: frozen(value=m.value))
    )
    receiver, got = node("receiver", "adapt"), list[Message]()
    receiver.create_subscription(new, "speeds", got.append, 10)
    theirs = old.__nested__[0]
    node("old").create_publisher(old, "speeds", 10).publish(
        old(name="n", first=theirs(value=0.5), more=[theirs(value=0.25)])
    )
    spin(receiver)
    assert got == [new(name="n", first=part(value=0.5, source="s"), more=[part(value=0.25, source="s")])]


def test_without_an_adapter_it_is_refused_and_the_warning_says_what_writes_one(
    heard: list[Mismatch], capfd: pytest.CaptureFixture[str]
) -> None:
    receiver, got = node("receiver", "adapt"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, 10)
    node("old").create_publisher(Old, "speed", 10).publish(Old())
    node("new").create_publisher(New, "speed", 10).publish(New())
    spin(receiver)
    assert got == []
    assert [mismatch.policy for mismatch in heard] == ["refuse"]
    assert f"ifgen adapt {SPEED} --from {Old.__type_hash__[:23]}" in capfd.readouterr().err


def test_a_publisher_that_adapts_changes_nothing() -> None:
    register(Adapter(Old, New, upgrade, lambda new: Old(value=new.value)))
    receiver, got = node("receiver"), list[Message]()
    receiver.create_subscription(Old, "speed", got.append, 10)
    node("sender", "adapt").create_publisher(New, "speed", 10).publish(New(value=0.1))
    spin(receiver)
    assert got != [Old(value=0.1)]


@pytest.mark.parametrize("fault", ["it raises", "it returns something else"])
def test_an_adapter_that_fails_is_said_once_and_spinning_goes_on(
    fault: str, log: Callable[[], list[str]]
) -> None:
    def fail(old: Message) -> Message:
        if old.value > 0:
            return New(value=old.value)
        if fault == "it raises":
            raise ValueError(fault)
        return old

    register(Adapter(Old, New, fail))
    receiver, got = node("receiver", "adapt"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, 10)
    publisher = node("old").create_publisher(Old, "speed", 10)
    log()
    for value in (0.0, 0.5, 0.0, 0.25):
        publisher.publish(Old(value=value))
    spin(receiver)
    assert [message.value for message in got] == [0.5, 0.25]
    (line,) = log()
    assert "topic '/speed': The adapter for /old failed with" in line
    assert ("ValueError: it raises (test_adapt.py:" if fault == "it raises" else "expected Speed") in line


def test_raw_subscriptions_get_the_bytes() -> None:
    register(Adapter(Old, New, upgrade))
    receiver, got = node("receiver", "adapt"), list[Any]()
    receiver.create_subscription(New, "speed", lambda data, info: got.append((data, info)), 10, raw=True)
    publisher = node("old").create_publisher(Old, "speed", 10)
    publisher.publish(Old(value=0.5))
    publisher.publish(serialize(Old(value=0.25)))
    spin(receiver)
    assert [data for data, _ in got] == [serialize(Old(value=0.5)), serialize(Old(value=0.25))]
    assert {type(data) for data, _ in got} == {bytes}
    assert [info["publication_sequence_number"] for _, info in got] == [1, 2]


def test_views_of_adapted_messages() -> None:
    old, new = (
        class_from_text("demo_msgs/msg/Row", "float32[] a"),
        class_from_text("demo_msgs/msg/Row", "float64[] a"),
    )
    seen: list[type] = []

    def convert(message: Message) -> Message:
        seen.append(type(message.a))
        return new(a=list(message.a))

    register(Adapter(old, new, convert))
    receiver, got = node("receiver", "adapt"), list[Message]()
    receiver.create_subscription(new, "row", got.append, 10, views=True)
    node("old").create_publisher(old, "row", 10).publish(old(a=[0.5, 0.25]))
    spin(receiver)
    assert got[0].a.tolist() == [0.5, 0.25]
    assert type(got[0].a).__name__ == "SequenceView"
    assert seen == [type(old(a=[0.5]).a)]


def test_late_subscriptions_adapt_what_durable_publishers_hold() -> None:
    register(Adapter(Old, New, upgrade))
    publisher = node("old").create_publisher(Old, "speed", LATCHED)
    publisher.publish(Old(value=0.5))
    receiver, got = node("receiver", "adapt"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, LATCHED)
    publisher.publish(Old(value=0.25))
    spin(receiver)
    assert [message.value for message in got] == [0.5, 0.25]


def test_a_class_without_a_hash_is_read_as_it_comes(log: Callable[[], list[str]]) -> None:
    unknown = class_from_text(SPEED, "float64 value\nstring source\nuint8 UNKNOWN=1")
    unknown.__type_hash__ = ""
    receiver, got = node("receiver", "refuse"), list[Message]()
    receiver.create_subscription(New, "speed", got.append, 10)
    node("sender").create_publisher(unknown, "speed", 10).publish(unknown(value=0.1))
    spin(receiver)
    assert got == [New(value=0.1)]
    assert count(log(), "does not say which definition") == 1

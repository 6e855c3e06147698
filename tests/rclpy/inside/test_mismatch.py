"""Topics whose two ends have different definitions: what is said, refused, adapted and counted."""

from __future__ import annotations

import contextlib
import gc
import random
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from ifgen.dynamic import class_from_text
from ifgen_runtime import adapters
from ifgen_runtime.adapters import Adapter, register
from ifgen_runtime.codec import serialize
from ifgen_runtime.codec.decoding import size_of
from ifgen_runtime.mismatch import listeners, told
from ifgen_runtime.mismatch.explanation import in_one_line
from ifgen_runtime.mismatch.sides import Mismatch
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rmw_local import observer, telling, virtual_time
from rmw_local.message import DecodeError, message_type
from rmw_local.origin import Origin

LATCHED = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
Message = Any
_nodes: list[Node] = []  # of the present test: what nobody holds leaves the graph

SPEED = "demo_msgs/msg/Speed"
Old = class_from_text(SPEED, "float32 value")
New = class_from_text(SPEED, "float64 value\nstring source")
Longer = class_from_text(SPEED, "float64 value\nstring source\nuint8[] rest")


def upgrade(old: Message) -> Message:
    assert type(old) is Old
    return New(value=old.value, source="adapted")


@pytest.fixture(autouse=True)
def _ros(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(adapters, "_registered", {})
    monkeypatch.setattr(adapters, "_found", {})
    monkeypatch.setattr(telling, "explanation", in_one_line)  # whether or not the toolkit is installed
    rclpy.init()
    yield
    while _nodes:
        _nodes.pop().destroy_node()
    rclpy.try_shutdown()


@pytest.fixture
def heard(monkeypatch: pytest.MonkeyPatch) -> list[Mismatch]:
    """What the listener for strict mode hears."""
    noted: list[Mismatch] = []
    monkeypatch.setattr(listeners, "heard", noted.append)
    return noted


@pytest.fixture
def log(capfd: pytest.CaptureFixture[str]) -> Callable[[], list[str]]:
    """The warnings since the last call."""
    return lambda: [line for line in capfd.readouterr().err.splitlines() if "[WARN]" in line]


def node(name: str, policy: str = "", **arguments: Any) -> Node:
    """A node with a policy of its own."""
    overrides = [Parameter("on_type_mismatch", value=policy)] if policy else []
    made = Node(name, parameter_overrides=overrides, **arguments)
    _nodes.append(made)
    return made


def spin(receiver: Node, times: int = 8) -> None:
    for _ in range(times):
        rclpy.spin_once(receiver, timeout_sec=0)


def spin_until_shutdown(receiver: Node) -> None:
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(receiver)


def count(lines: list[str], text: str) -> int:
    return sum(text in line for line in lines)


# To warn


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
    assert "topic '/speed': 7 bytes of a message of /sender are left over. The message was delivered." in line
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
    assert "bytes of a message of /sender are left over" in line
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
    assert len(warnings) == told.PAIRS + 1
    assert "which is not said any more" in warnings[-1]
    for index in range(1000):
        names = f"speed{index}"
        ends = (receiver.create_subscription(New, names, print, 1), sender.create_publisher(Old, names, 1))
        receiver.destroy_subscription(ends[0])
        sender.destroy_publisher(ends[1])
    assert len(log()) == told.NAMES - 1 + told.PAIRS + 1
    assert len(reader.node.participant.told._counts) == told.NAMES + 1
    gc.collect()
    assert reader.encounters == ()


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


# To refuse


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
    assert topic._refused == []


# To adapt


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
    assert ("ValueError: it raises (test_mismatch.py:" if fault == "it raises" else "expected Speed") in line


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


# The policy


def test_a_class_attribute_and_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    class Refusing(Node):
        on_type_mismatch = "refuse"

    monkeypatch.setenv("IFGEN_ON_TYPE_MISMATCH", "adapt")
    override = [Parameter("on_type_mismatch", value="warn")]
    policies = [
        each.handle.graph_node.on_type_mismatch
        for each in (node("plain"), Refusing("class"), Refusing("override", parameter_overrides=override))
    ]
    assert policies == ["adapt", "refuse", "warn"]


def test_a_policy_on_the_command_line() -> None:
    chosen = node("n", cli_args=["--ros-args", "-p", "on_type_mismatch:=refuse"])
    assert chosen.handle.graph_node.on_type_mismatch == "refuse"


def test_a_policy_that_does_not_exist_is_refused() -> None:
    with pytest.raises(
        ValueError, match="parameter on_type_mismatch is 'stop', expected one of warn, refuse, adapt"
    ):
        node("n", "stop")


def test_a_declared_parameter_counts_for_endpoints_that_meet_from_then_on() -> None:
    receiver, got = node("receiver"), list[Message]()
    receiver.create_subscription(New, "before", got.append, 10)
    node("old").create_publisher(Longer, "before", 10).publish(Longer())
    receiver.declare_parameter("on_type_mismatch", "warn")
    (result,) = receiver.set_parameters([Parameter("on_type_mismatch", value="stop")])
    assert not result.successful
    assert "expected one of warn, refuse, adapt" in result.reason
    (result,) = receiver.set_parameters([Parameter("on_type_mismatch", value="refuse")])
    assert result.successful
    receiver.create_subscription(New, "after", lambda _: pytest.fail("refused"), 10)
    node("older").create_publisher(Longer, "after", 10).publish(Longer())
    spin(receiver)
    assert len(got) == 1
    receiver.undeclare_parameter("on_type_mismatch")
    assert receiver.handle.graph_node.on_type_mismatch == "warn"


# All at once


def test_lifecycle_nodes() -> None:
    register(Adapter(Old, New, upgrade))
    sender = LifecycleNode("sender")
    _nodes.append(sender)
    publisher = sender.create_lifecycle_publisher(Old, "speed", 10)
    receiver = LifecycleNode("receiver", parameter_overrides=[Parameter("on_type_mismatch", value="adapt")])
    _nodes.append(receiver)
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

"""Content filters: the grammar of Fast DDS, and subscriptions that have one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rclpy.subscription_content_filter_options import ContentFilterOptions
from rmw_local.content_filter import FilterError, compile_filter, sieve_of
from rmw_local.message import message_type
from rmw_local.transports.link import _PublicationSink
from test_msgs.msg import Arrays, BasicTypes, Strings, UnboundedSequences

from tests.rclpy.inside.contract.processes import connected

BASIC = BasicTypes(
    int32_value=5, uint8_value=5, float64_value=1.5, bool_value=True, char_value=66, byte_value=b"\x03"
)


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    yield rclpy.create_node("n")
    rclpy.try_shutdown()


@pytest.mark.parametrize(
    ("expression", "parameters", "is_true"),
    [
        ("int32_value = 5", [], True),
        ("5 < int32_value", [], False),
        ("int32_value <> %0", ["6"], True),
        ("int32_value != 0x05", [], False),
        ("int32_value = uint8_value", [], True),
        ("float64_value >= 1", [], True),
        ("int32_value < 5.5 AND NOT float64_value > 2e0", [], True),
        ("int32_value = 1 OR int32_value = 5 AND bool_value = FALSE", [], False),
        ("(int32_value = 1 OR int32_value = 5) and bool_value = 1", [], True),
        ("int32_value BETWEEN %0 AND %1", ["5", "7"], True),
        ("int32_value NOT BETWEEN 5 AND 7", [], False),
        ("char_value = 66 AND byte_value = 3", [], True),
        ("bool_value = true", [], True),
    ],
)
def test_an_expression_is_true(expression: str, parameters: list[str], is_true: bool) -> None:
    compiled = compile_filter(BasicTypes, expression, parameters)
    assert compiled is not None
    assert compiled.accepts(BASIC) is is_true


@pytest.mark.parametrize(
    ("expression", "is_true"),
    [
        ("string_value = 'arm_left'", True),
        ("string_value LIKE 'arm%'", True),
        ("string_value like 'arm?left'", True),
        ("string_value LIKE 'arm'", False),
        ("string_value MATCH 'arm_(left|right)'", True),
        ("string_value MATCH 'arm'", False),
        ("string_value < 'b' AND string_value <> ''", True),
        ("string_value = %0", True),
    ],
)
def test_texts(expression: str, is_true: bool) -> None:
    compiled = compile_filter(Strings, expression, ["'arm_left'"])
    assert compiled is not None
    assert compiled.accepts(Strings(string_value="arm_left")) is is_true


def test_elements_and_nested_fields() -> None:
    in_array = compile_filter(Arrays, "int32_values[1] = 2 AND basic_types_values[0].int32_value = 0", [])
    assert in_array is not None
    assert in_array.accepts(Arrays(int32_values=[1, 2, 3]))
    in_sequence = compile_filter(UnboundedSequences, "int32_values[2] = 0", [])
    assert in_sequence is not None
    assert not in_sequence.accepts(UnboundedSequences(int32_values=[0]))
    assert compile_filter(Arrays, "  ", []) is None


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("int32_value == 5", "expected a field or a literal, found '='"),
        ("1 = 1", "a comparison needs a field"),
        ("int32_value", "expected a comparison, found the end"),
        ("int32_value + 1 = 2", "no part of an expression"),
        ("int32_value IN 1", "expected a comparison, found 'IN'"),
        ('int32_value = "a"', "no part of an expression"),
        ("int32_value = 'a'", "a number does not compare with a text"),
        ("Int32_value = 1", "there is no field 'Int32_value'"),
        ("int32_value = %3", "there is no parameter for %3"),
        ("int32_value = %0", "texts need quotes"),
        ("(int32_value = 1", r"expected '\)', found the end"),
        ("int32_value = 1 int32_value = 2", "expected AND, OR or the end"),
        ("int32_value[0] = 1", "has no elements"),
        ("char_value = 'B'", "a number does not compare with a text"),
    ],
)
def test_a_wrong_expression_is_refused(expression: str, expected: str) -> None:
    with pytest.raises(FilterError, match=expected):
        compile_filter(BasicTypes, expression, ["text"])
    with pytest.raises(FilterError, match=r"'int32_values' of 'int32_values' needs an index"):
        compile_filter(Arrays, "int32_values = 1", [])
    with pytest.raises(FilterError, match=r"has 3 elements, no \[3\]"):
        compile_filter(Arrays, "int32_values[3] = 1", [])


def test_a_subscription_gets_what_its_filter_accepts(node: Node) -> None:
    durable = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher, heard, raw = node.create_publisher(BasicTypes, "t", durable), [], []

    def publish(*numbers: int) -> None:
        for number in numbers:
            publisher.publish(BasicTypes(int32_value=number))
        for _ in range(20):
            rclpy.spin_once(node, timeout_sec=0)

    publish(1, 2, 3)
    wanted = ContentFilterOptions("int32_value > %0", ["1"])
    callback: Any = lambda message: heard.append(message.int32_value)  # noqa: E731 - it is one expression
    late = node.create_subscription(BasicTypes, "t", callback, durable, content_filter_options=wanted)
    bytes_only: Any = raw.append
    node.create_subscription(BasicTypes, "t", bytes_only, 10, raw=True, content_filter_options=wanted)
    publish(0, 4)
    assert heard == [2, 3, 4]
    assert raw == [serialize_message(BasicTypes(int32_value=4))]
    assert late.is_cft_enabled
    assert late.get_content_filter() == wanted
    late.set_content_filter("int32_value = 0", [])
    with pytest.raises(_rclpy.RCLError, match=r"^Failed to set cft expression parameters: .*no field 'x'"):
        late.set_content_filter("x = 1", [])
    publish(0, 4)
    assert heard == [2, 3, 4, 0]
    late.set_content_filter("", [])
    assert not late.is_cft_enabled
    publish(4)
    assert heard == [2, 3, 4, 0, 4]
    with pytest.raises(_rclpy.RCLError, match=r"^Failed to get cft expression parameters"):
        late.get_content_filter()
    node.destroy_subscription(late)
    with pytest.raises(rclpy.exceptions.InvalidHandle):
        assert late.is_cft_enabled


def test_a_subscription_with_a_wrong_filter_is_not_created(node: Node) -> None:
    def create(options: Any) -> None:
        node.create_subscription(BasicTypes, "t", print, 1, content_filter_options=options)

    with pytest.raises(_rclpy.RCLError, match=r"^Failed to create subscription: "):
        create(ContentFilterOptions("x = 1", []))
    with pytest.raises(_rclpy.RCLError, match=r"^Failed to set content_filter_options: The maximum of"):
        create(ContentFilterOptions("int32_value = %0", ["1"] * 101))
    with pytest.raises(TypeError):
        create(ContentFilterOptions("int32_value = %0", [1]))  # type: ignore[list-item]
    with pytest.raises(AttributeError, match="filter_expression"):
        create(("int32_value = 1", []))
    assert node.count_subscribers("t") == 0


@pytest.mark.parametrize("kind", ["recorded", "zenoh"])
def test_what_no_process_wants_is_not_sent(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[int] = []
    plain = _PublicationSink.accept

    def count(sink: Any, sample: Any) -> None:
        sent.append(len(sample[0]))
        plain(sink, sample)

    monkeypatch.setattr(_PublicationSink, "accept", count)
    heard: list[int] = []
    lost: list[Any] = []
    callback: Any = lambda message: heard.append(message.int32_value)  # noqa: E731 - it is one expression
    events = SubscriptionEventCallbacks(message_lost=lost.append)
    with connected(kind) as pair:
        here, there = pair.process("here").node, pair.process("there").node
        publisher = here.create_publisher(BasicTypes, "t", 100)
        filtered = there.create_subscription(
            BasicTypes,
            "t",
            callback,
            100,
            content_filter_options=ContentFilterOptions("int32_value BETWEEN %0 AND %1", ["90", "92"]),
            event_callbacks=events,
        )

        def publish(expected: list[int]) -> None:
            sent.clear()
            pair.until(lambda: publisher.get_subscription_count() == sum(1 for _ in there.subscriptions))
            for number in range(100):
                publisher.publish(BasicTypes(int32_value=number))
            pair.until(lambda: len(heard) == len(expected))
            assert heard == expected
            heard.clear()

        publish([90, 91, 92])
        assert sum(sent) == 3 * 52
        assert publisher.wait_for_all_acked(Duration(seconds=10))
        filtered.set_content_filter("int32_value = 5", [])
        pair.until(lambda: there.count_subscribers("t") == here.count_subscribers("t") == 1)
        pair.settle()
        publish([5])
        assert len(sent) == 1
        all_of_them = there.create_subscription(BasicTypes, "t", lambda _: None, 100)
        publish([5])
        assert len(sent) == 100
        there.destroy_subscription(all_of_them)
        publish([5])
        assert len(sent) == 1
        filtered.set_content_filter("", [])
        pair.settle()
        publish(list(range(100)))
    assert not lost


@pytest.mark.parametrize("pattern", ["LIKE 'a%'", "match 'a.*'"])
def test_patterns_of_others_are_not_evaluated(pattern: str) -> None:
    class Sink:
        accept = assert_alive = wait_until_received = announce = None

    class Writer:
        message_type = message_type(Strings)
        last_elsewhere = 3

    writer: Any = Writer()
    sink: Any = Sink()
    assert sieve_of(writer, sink, [(f"string_value {pattern}", ())]) is None
    assert sieve_of(writer, sink, [("(" * 2000, ())]) is None
    made = sieve_of(writer, sink, [("string_value = 'a'", ())])
    assert made is not None
    assert made.last == 3

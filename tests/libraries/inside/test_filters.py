"""Subscribers, caches, chains and the other filters: upstream's cases and what programs rely on."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
import rclpy
from message_filters import Cache, Chain, SimpleFilter, Subscriber, TimeSynchronizer
from message_filters.delta_filter import (
    CachedComparisonHandler,
    ComparisonFilter,
    ComparisonHandler,
    DeltaCompare,
    DeltaFilter,
    PathDeltaFilter,
)
from message_filters.input_aligner import InputAligner, QueueStatus
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import ClockType, ROSClock
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from std_msgs.msg import ColorRGBA, Header, Int32, String


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    node = rclpy.create_node("filters", namespace="/my_ns")
    yield node
    node.destroy_node()
    rclpy.shutdown()


def stamped(seconds: float, data: Any = None) -> Any:
    """A message with a `Time` as its stamp, as upstream's tests have them."""
    return SimpleNamespace(header=SimpleNamespace(stamp=Time(seconds=seconds)), data=data)


def test_callbacks_come_in_order_and_go() -> None:
    calls: list[Any] = []
    source = SimpleFilter()
    first = source.registerCallback(lambda *words: calls.append(("a", *words)), 1)
    source.registerCallback(lambda *words: calls.append(("b", *words)))
    source.signalMessage("x", "y")
    assert calls == [("a", "x", "y", 1), ("b", "x", "y")]
    source.unregisterCallback(first)
    source.unregisterCallback(first)
    source.unregisterCallback(9999)
    third = source.registerCallback(calls.append)
    assert third not in {first, 1}  # or it would take the place of b
    calls.clear()
    source.signalMessage("z")
    assert calls == [("b", "z"), "z"]


def test_a_callback_may_unregister_itself() -> None:
    source, calls = SimpleFilter(), []

    def once(message: str) -> None:
        calls.append(message)
        source.unregisterCallback(connection)

    connection = source.registerCallback(once)
    source.signalMessage("x")
    source.signalMessage("y")
    assert calls == ["x"]


def test_a_subscriber_is_a_subscription(node: Node) -> None:
    group = ReentrantCallbackGroup()
    quality = QoSProfile(depth=3, reliability=ReliabilityPolicy.BEST_EFFORT)
    plain = Subscriber(node, String, "words")
    by_depth = Subscriber(node, String, "/words", 7)
    own = Subscriber(node, String, "words", qos_profile=quality, callback_group=group)
    assert (plain.getTopic(), by_depth.topic, plain.node) == ("words", "/words", node)
    assert (plain.topic_name, by_depth.topic_name) == ("/my_ns/words", "/words")  # of the subscription
    assert [each.sub.qos_profile.depth for each in (plain, by_depth, own)] == [10, 7, 3]
    assert own.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
    assert own.callback_group is group
    with pytest.raises(AttributeError, match="no_such_thing"):
        _ = plain.no_such_thing
    with pytest.raises(TypeError, match="no_such_option"):
        Subscriber(node, String, "words", no_such_option=1)
    with pytest.raises(AttributeError, match="sub"):
        copy.copy(Subscriber.__new__(Subscriber)).getAnything()


def test_messages_of_a_topic_go_through(node: Node) -> None:
    heard: list[str] = []
    cache = Cache(Subscriber(node, String, "words"), 2, allow_headerless=True)
    cache.registerCallback(lambda message: heard.append(message.data))
    publisher = node.create_publisher(String, "words", 10)
    while not publisher.get_subscription_count():
        rclpy.spin_once(node, timeout_sec=0.01)
    for word in ("a", "b", "c"):
        publisher.publish(String(data=word))
    while len(heard) < 3:
        rclpy.spin_once(node, timeout_sec=1)
    assert heard == ["a", "b", "c"]
    assert [message.data for message in cache.cache_msgs] == ["b", "c"]


def test_a_cache_answers_by_time() -> None:
    cache = Cache(SimpleFilter(), 5)
    assert (cache.getLastestTime(), cache.getOldestTime(), cache.getLast()) == (None, None, None)
    for second in range(5):
        cache.add(stamped(second))
    assert len(cache.getInterval(Time(seconds=2.5), Time(seconds=3.5))) == 1
    assert len(cache.getInterval(Time(seconds=2), Time(seconds=3))) == 2
    assert len(cache.getInterval(Time(), Time(seconds=4))) == 5
    with pytest.raises(AssertionError):
        cache.getInterval(Time(seconds=4), Time())
    assert cache.getElemAfterTime(Time()).header.stamp == Time()
    assert cache.getElemBeforeTime(Time(seconds=3.5)).header.stamp == Time(seconds=3)
    assert cache.getElemAfterTime(Time(seconds=4.1)) is None
    assert (cache.getLastestTime(), cache.getOldestTime()) == (Time(seconds=4), Time())
    assert cache.getLast().header.stamp == Time(seconds=4)
    cache.add(stamped(5))
    assert cache.getOldestTime() == Time(seconds=1)


def test_a_cache_keeps_the_order_in_which_messages_came() -> None:
    cache = Cache(SimpleFilter(), cache_size=3)
    for second in (2, 3, 1):
        cache.add(stamped(second))
    assert (cache.getLastestTime(), cache.getOldestTime()) == (Time(seconds=1), Time(seconds=2))
    assert cache.getElemAfterTime(Time(seconds=1)).header.stamp == Time(seconds=2)
    assert cache.getElemBeforeTime(Time(seconds=9)).header.stamp == Time(seconds=1)
    assert cache.getLast().header.stamp == Time(seconds=2)


def test_a_cache_of_messages_without_headers(capfd: pytest.CaptureFixture[str]) -> None:
    refusing = Cache(SimpleFilter(), 5)
    refusing.add(String())
    assert refusing.cache_msgs == []
    assert (
        "[message_filters_cache]: can not use message filters messages without timestamp infomation when "
        "'allow_headerless' is disabled. auto assign ROSTIME to headerless messages once enabling constructor "
        "option of 'allow_headerless'." in capfd.readouterr().err
    )
    cache = Cache(SimpleFilter(), 5, allow_headerless=True)
    before = ROSClock().now()
    cache.add(String(data="a"))
    between = ROSClock().now()
    assert before <= cache.getLastestTime() <= between
    assert cache.getElemAfterTime(Time(clock_type=ClockType.ROS_TIME)) == String(data="a")
    assert cache.getInterval(Time(clock_type=ClockType.ROS_TIME), between) == [String(data="a")]
    cache.add(Header(stamp=between.to_msg()))  # a header itself has none
    assert len(cache.cache_msgs) == 2


def test_age_in_virtual_time() -> None:
    virtual = pytest.importorskip("rmw_local.virtual_time", reason="real rclpy has no virtual time")
    import time

    with virtual.virtual_time():
        cache = Cache(SimpleFilter(), 100, allow_headerless=True)
        start = ROSClock().now()
        for hour in range(24):
            cache.add(Int32(data=hour))
            time.sleep(3600)
        wanted = cache.getInterval(start + Duration(seconds=3600.0), start + Duration(seconds=3 * 3600.0))
        assert [message.data for message in wanted] == [1, 2, 3]


def test_a_chain_is_one_filter() -> None:
    source, chain, heard = SimpleFilter(), Chain(), []
    chain.registerCallback(heard.append)
    chain.connectInput(source)
    source.signalMessage("through an empty chain")
    with pytest.raises(KeyError):
        chain.getFilter(0)
    first, second = Cache(SimpleFilter(), 3), Cache(SimpleFilter(), 3)
    for number, each in enumerate((first, second)):
        chain.addFilter(each)
        assert chain.getFilter(number) is each
        source.signalMessage(stamped(number, number))
    assert [message.data for message in first.cache_msgs] == [0, 1]
    assert [message.data for message in second.cache_msgs] == [1]
    assert [getattr(message, "data", message) for message in heard] == ["through an empty chain", 0, 1]
    with pytest.raises(RuntimeError, match="Already connected"):
        chain.connectInput(source)
    with pytest.raises(RuntimeError, match="Already connected"):
        Chain(source).connectInput(source)


def test_a_chain_leaves_other_callbacks_alone() -> None:
    chain, cache, heard = Chain(), Cache(SimpleFilter()), []
    chain.addFilter(cache)
    cache.registerCallback(heard.append)
    chain.addFilter(Cache(SimpleFilter()))
    chain.add(stamped(1, "kept"))
    assert [message.data for message in heard] == ["kept"]


def test_a_synchronizer_of_subscribers_and_caches() -> None:
    caches = [Cache(SimpleFilter(), 10) for _ in range(2)]
    heard: list[Any] = []
    TimeSynchronizer(caches, queue_size=10).registerCallback(lambda *messages: heard.append(messages))
    messages = [SimpleNamespace(header=Header(stamp=Time(seconds=1).to_msg())) for _ in caches]
    for cache, message in zip(caches, messages, strict=True):
        cache.add(message)
    assert heard == [tuple(messages)]


@pytest.mark.parametrize(("one", "other"), [("a", "b"), (True, False), (10, 11), (0.1, 0.2)])
def test_what_differs_goes_through(one: Any, other: Any) -> None:
    compare = DeltaCompare([lambda message: message.data])
    values = [one, one, other, other, one]
    assert [compare.message_fits(SimpleNamespace(data=value)) for value in values] == [
        True,
        False,
        True,
        False,
        True,
    ]
    compared = f"Unable to compare fields of types {type(one)} and <class 'list'>"
    with pytest.raises(TypeError, match=compared):
        compare.message_fits(SimpleNamespace(data=[1]))


@pytest.mark.parametrize(
    "make",
    [
        lambda source: DeltaFilter([lambda m: m.r, lambda m: m.g], source),
        lambda source: PathDeltaFilter(["r", "g"], source),
    ],
)
def test_delta_filters(make: Any) -> None:
    source, heard = SimpleFilter(), []
    changes = make(source)
    changes.registerCallback(heard.append)
    for r, g, b in ((0.1, 0.0, 0.0), (0.1, 0.0, 0.5), (0.1, 0.2, 0.5), (0.2, 0.2, 0.5)):
        source.signalMessage(ColorRGBA(r=r, g=g, b=b))
    assert [(round(each.r, 1), round(each.g, 1)) for each in heard] == [(0.1, 0.0), (0.1, 0.2), (0.2, 0.2)]
    with pytest.raises(RuntimeError, match="already has an incoming connection"):
        changes.connectInput(source)


def test_paths_of_fields() -> None:
    changes = PathDeltaFilter(["header.stamp.sec", "header.frame"])
    message = SimpleNamespace(header=Header())
    assert changes.get_field_by_path(message, "header.stamp.sec") == 0
    reason = "Unable to access field 'frame' of Header (full path: 'header.frame')"
    with pytest.raises(RuntimeError) as caught:
        changes.get_field_by_path(message, "header.frame")
    assert str(caught.value) == reason


def test_handlers_that_users_write() -> None:
    class Every(CachedComparisonHandler):
        def message_fits(self, message: Any) -> bool:
            return message % 2 == 0

    heard: list[int] = []
    evens = ComparisonFilter(comparison_handler=Every(), message_filter=SimpleFilter())
    evens.registerCallback(heard.append)
    for number in range(4):
        evens.add(number)
    assert heard == [0, 2]
    with pytest.raises(NotImplementedError, match=r"for class: Every\. Consider implementing do_fields"):
        Every().do_fields_fit(1, 2)
    with pytest.raises(NotImplementedError):
        ComparisonHandler().message_fits(1)


def aligner(
    inputs: int, timeout: float = 1.0, period: float | None = 0.002
) -> tuple[InputAligner, list[Any]]:
    made, heard = InputAligner(Duration(seconds=timeout)), []
    made.connectInput(filters=[SimpleFilter() for _ in range(inputs)])
    for index in range(inputs):
        made.registerCallback(index, lambda message: heard.append(message.data))
        if period is not None:
            made.setInputPeriod(index, Duration(seconds=period))
    return made, heard


def feed(made: InputAligner, *events: tuple[int, int]) -> None:
    """Add messages, each a time in ms and its input, and pass on what can be."""
    for time, index in events:
        header = Header(stamp=Time(nanoseconds=time * 10**6).to_msg())
        made.add(SimpleNamespace(header=header, data=time), index)
    made.dispatchMessages()


@pytest.mark.parametrize("last", [(), ((9, 0),)])
def test_aligned_inputs_come_in_the_order_of_their_times(last: tuple[tuple[int, int], ...]) -> None:
    made, heard = aligner(4, period=0.004)
    feed(made, (3, 2), (1, 0), (7, 2), (5, 0), (2, 3), (9, 0), *last, (4, 1), (8, 1), (6, 3))
    assert heard == [*range(1, 10), *(time for time, _ in last)]


def test_aligned_inputs_that_never_speak_are_not_waited_for() -> None:
    made, heard = aligner(3)
    feed(made, (2, 2), (1, 1), (4, 2), (3, 1), (5, 1))
    assert heard == [1, 2, 3, 4, 5]


def test_an_aligned_input_that_falls_silent_is_given_up_after_a_while() -> None:
    made, heard = aligner(2, timeout=0.01)
    feed(made, *((time, 0) for time in range(1, 17, 2)), (2, 1), (4, 1))
    assert heard == [1, 2, 3, 4, 5]
    feed(made, (17, 0))
    assert heard == [1, 2, 3, 4, 5, 7, 9, 11, 13, 15, 17]


def test_aligned_messages_that_come_too_late_are_dropped() -> None:
    made, heard = aligner(2)
    feed(made, (4, 1), (3, 0))
    assert heard == [3, 4]
    feed(made, (1, 0), (5, 0), (7, 0), (2, 1), (6, 1))
    assert heard == [3, 4, 5, 6, 7]
    assert [made.getQueueStatus(index).msgs_dropped for index in (0, 1)] == [1, 1]


def test_aligned_inputs_without_periods() -> None:
    made, heard = aligner(3, timeout=0.01, period=None)
    feed(made, (6, 0), (2, 2), (4, 2), (1, 1), (3, 1), (5, 1))
    assert heard == [1, 2, 3, 4]
    feed(made, (16, 0))
    assert heard == [1, 2, 3, 4, 5, 6, 16]


def test_the_state_of_aligned_inputs() -> None:
    def states(made: InputAligner) -> list[tuple[bool, int, int, int]]:
        found = [made.getQueueStatus(index) for index in (0, 1)]
        assert all(isinstance(each, QueueStatus) for each in found)
        return [(each.active, each.queue_size, each.msgs_processed, each.msgs_dropped) for each in found]

    made, _ = aligner(2, timeout=0.01)
    made.add(SimpleNamespace(header=Header(stamp=Time(nanoseconds=2_000_000).to_msg()), data=2), 1)
    assert states(made) == [(False, 0, 0, 0), (False, 1, 0, 0)]
    feed(made, (3, 0), (5, 0))
    assert states(made) == [(True, 1, 1, 0), (True, 0, 1, 0)]
    feed(made, (1, 0), (17, 0))
    assert states(made) == [(True, 0, 3, 1), (False, 0, 1, 0)]


def test_aligned_inputs_are_connected_anew(node: Node) -> None:
    sources = [SimpleFilter() for _ in range(3)]
    made, heard = InputAligner(Duration(seconds=1), filters=sources), []
    made.registerCallback(0, lambda message: heard.append("stale"))
    made.connectInput(filters=sources[:2])
    assert (len(made.event_queues), len(made.signals), len(made.input_connections)) == (2, 2, 2)
    for index in range(2):
        made.registerCallback(index, lambda message, mark: heard.append((message.data, mark)), index)
    for time, source in zip((1, 2, 3), (sources[2], *sources[:2]), strict=True):
        source.signalMessage(SimpleNamespace(header=Header(stamp=Time(seconds=time).to_msg()), data=time))
    made.setupDispatchTimer(node, Duration(seconds=0.01))
    while len(heard) < 2:
        rclpy.spin_once(node, timeout_sec=1)
    assert heard == [(2, 0), (3, 1)]
    made.disconnectAll()
    sources[0].signalMessage(SimpleNamespace(header=Header(stamp=Time(seconds=4).to_msg()), data=4))
    made.dispatchMessages()
    assert len(heard) == 2
    made.setName("camera")
    assert (made.getName(), InputAligner(Duration(seconds=1)).getName()) == ("camera", "")


def test_this_is_ours() -> None:
    """Nothing else of that name is installed; the comparisons above would be with that one."""
    import message_filters

    assert f"{os.sep}libraries{os.sep}" in message_filters.__file__

"""Messages that belong together: upstream's cases, and a slow model of what has to come out."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import message_filters
import pytest
import rclpy
from hypothesis import given
from hypothesis import strategies as st
from message_filters import ApproximateTimeSynchronizer, SimpleFilter, TimeSynchronizer
from rclpy.clock import ROSClock
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future
from rclpy.time import Time
from std_msgs.msg import Header, String

Sets = list[tuple[Any, ...]]


def message(nanoseconds: int, data: Any = None) -> Any:
    return SimpleNamespace(header=Header(stamp=Time(nanoseconds=nanoseconds).to_msg()), data=data)


def collected(synchronizer: SimpleFilter) -> Sets:
    found: Sets = []
    synchronizer.registerCallback(lambda *msgs: found.append(msgs))
    return found


@dataclass
class Model:
    """What waits, as (time, data) for each input, and what has come out."""

    queues: list[list[tuple[int, Any]]]
    queue_size: int
    out: list[tuple[Any, ...]]

    def keep(self, index: int, time: int, data: Any) -> None:
        queue = [entry for entry in self.queues[index] if entry[0] != time]
        place = (
            [entry[0] for entry in self.queues[index]].index(time)
            if len(queue) < len(self.queues[index])
            else len(queue)
        )
        queue.insert(place, (time, data))  # a dict keeps the place of a key
        while len(queue) > self.queue_size:
            queue.remove(min(queue, key=lambda entry: entry[0]))
        self.queues[index] = queue

    def pass_on(self, chosen: Sequence[tuple[int, Any]]) -> None:
        self.out.append(tuple(data for _, data in chosen))
        for queue, entry in zip(self.queues, chosen, strict=True):
            queue.remove(entry)

    def add_exactly(self, index: int, time: int, data: Any) -> None:
        self.keep(index, time, data)
        sets = [
            chosen for chosen in itertools.product(*self.queues) if len({time for time, _ in chosen}) == 1
        ]
        if sets:
            earliest = min(sets, key=lambda chosen: chosen[0][0])
            self.pass_on(earliest)
            self.queues = [[e for e in queue if e[0] >= earliest[0][0]] for queue in self.queues]

    def add_approximately(self, index: int, time: int, data: Any, slop: int) -> None:
        self.keep(index, time, data)
        inputs = [
            [(time, data)] if other == index else sorted(queue, key=lambda entry: abs(entry[0] - time))
            for other, queue in enumerate(self.queues)
        ]
        for chosen in itertools.product(*inputs):
            times = [each for each, _ in chosen]
            if (time, data) in self.queues[index] and max(times) - min(times) < slop:
                self.pass_on(chosen)
                return


arrivals = st.integers(1, 4).flatmap(
    lambda inputs: st.tuples(
        st.just(inputs), st.lists(st.tuples(st.integers(0, inputs - 1), st.integers(0, 12)), max_size=40)
    )
)


@given(arrivals, st.integers(1, 5))
def test_same_times_are_as_the_model_says(case: tuple[int, list[tuple[int, int]]], queue_size: int) -> None:
    inputs, events = case
    filters = [SimpleFilter() for _ in range(inputs)]
    synchronizer = TimeSynchronizer(filters, queue_size)
    found = collected(synchronizer)
    model = Model([[] for _ in filters], queue_size, [])
    for number, (index, time) in enumerate(events):
        filters[index].signalMessage(message(time, number))
        model.add_exactly(index, time, number)
        assert [tuple(each.data for each in msgs) for msgs in found] == model.out
        waiting = [[(time, each.data) for time, each in queue.items()] for queue in synchronizer.queues]
        assert [sorted(queue) for queue in waiting] == [sorted(queue) for queue in model.queues]


@given(arrivals, st.integers(1, 5), st.integers(0, 8))
def test_near_times_are_as_the_model_says(
    case: tuple[int, list[tuple[int, int]]], queue_size: int, slop: int
) -> None:
    inputs, events = case
    filters = [SimpleFilter() for _ in range(inputs)]
    synchronizer = ApproximateTimeSynchronizer(filters, queue_size, slop / 1e9)
    found = collected(synchronizer)
    model = Model([[] for _ in filters], queue_size, [])
    for number, (index, time) in enumerate(events):
        filters[index].signalMessage(message(time, number))
        model.add_approximately(index, time, number, slop)
        assert [tuple(each.data for each in msgs) for msgs in found] == model.out
        waiting = [[(time, each.data) for time, each in queue.items()] for queue in synchronizer.queues]
        assert waiting == model.queues


def test_pairs_come_out_as_soon_as_they_are_complete() -> None:
    for make in (lambda fs: TimeSynchronizer(fs, 1), lambda fs: ApproximateTimeSynchronizer(fs, 1, 0.1)):
        first, second = SimpleFilter(), SimpleFilter()
        found = collected(make([first, second]))
        for second_of_time in range(10):
            one, two = message(second_of_time * 10**9, 33), message(second_of_time * 10**9, 34)
            first.signalMessage(one)
            assert len(found) == second_of_time
            second.signalMessage(two)
            assert found[-1] == (one, two)


@pytest.mark.parametrize("count", range(1, 10))
def test_scrambled_messages_find_each_other(count: int) -> None:
    draw = random.Random(count)
    first, second = SimpleFilter(), SimpleFilter()
    found = collected(ApproximateTimeSynchronizer([first, second], count, 0.1))
    ones = [message(time * 10**9) for time in range(count)]
    twos = [message(time * 10**9) for time in range(count)]
    for each in draw.sample(ones, count):
        first.signalMessage(each)
    assert found == []
    for each in draw.sample(twos, count):
        second.signalMessage(each)
    assert sorted(map(id, itertools.chain(*found))) == sorted(map(id, ones + twos))
    assert all(one.header == two.header for one, two in found)


def test_what_is_older_than_a_set_is_forgotten() -> None:
    first, second = SimpleFilter(), SimpleFilter()
    found = collected(TimeSynchronizer([first, second], 10))
    for time in (1, 2, 3):
        first.signalMessage(message(time))
    for time in (2, 1, 3):
        second.signalMessage(message(time))
    assert [one.header.stamp.nanosec for one, _ in found] == [2, 3]


def test_slop_is_less_than_and_not_up_to() -> None:
    first, second = SimpleFilter(), SimpleFilter()
    found = collected(ApproximateTimeSynchronizer([first, second], 10, 0.1))
    first.signalMessage(message(0))
    second.signalMessage(message(100_000_000))
    assert found == []
    second.signalMessage(message(99_999_999))
    assert len(found) == 1


def test_stamps_may_be_times() -> None:
    """Upstream's own tests put them in headers."""
    first, second = SimpleFilter(), SimpleFilter()
    found = collected(ApproximateTimeSynchronizer([first, second], 2, 10, allow_headerless=True))
    first.signalMessage(SimpleNamespace(header=SimpleNamespace(stamp=ROSClock().now() + Duration(seconds=1))))
    second.signalMessage(String(data="has no header"))
    assert found[0][1] == String(data="has no header")


def test_messages_without_a_header_are_dropped_with_a_warning(capfd: pytest.CaptureFixture[str]) -> None:
    first, second = SimpleFilter(), SimpleFilter()
    synchronizer = ApproximateTimeSynchronizer([first, second], 2, 10)
    first.signalMessage(String())
    assert synchronizer.queues == [{}, {}]
    assert (
        "[message_filters_approx]: can not use message filters for messages without timestamp infomation when "
        "'allow_headerless' is disabled. auto assign ROSTIME to headerless messages once enabling constructor "
        "option of 'allow_headerless'." in capfd.readouterr().err
    )


@pytest.mark.parametrize(
    "make", [lambda fs: TimeSynchronizer(fs, 3), lambda fs: ApproximateTimeSynchronizer(fs, 3, 0.1)]
)
def test_a_callback_that_fails_or_adds_more_does_not_stop_the_next(
    make: Callable[..., TimeSynchronizer],
) -> None:
    first, second = SimpleFilter(), SimpleFilter()
    synchronizer = make([first, second])
    again = [message(10**9), message(2 * 10**9)]

    def fail_once(*_: Any) -> None:
        if again:
            time = again.pop()
            first.signalMessage(time)
            second.signalMessage(time)
            raise LookupError

    synchronizer.registerCallback(fail_once)
    found = collected(synchronizer)
    first.signalMessage(message(0))
    with pytest.raises(LookupError):
        second.signalMessage(message(0))
    first.signalMessage(message(3 * 10**9))
    second.signalMessage(message(3 * 10**9))
    assert [one.header.stamp.sec for one, _ in found] == [1, 3]


def test_many_messages_that_do_not_match_take_little_time() -> None:
    """Upstream tries each combination of those near: 100 ** 6 of them here."""
    filters = [SimpleFilter() for _ in range(7)]
    found = collected(ApproximateTimeSynchronizer(filters, 100, 1.0))
    for index, side in enumerate((0, 0, 0, 0, 700_000_000, -700_000_000), 1):
        for number in range(100):
            filters[index].signalMessage(message(10**10 + side + number))
    filters[0].signalMessage(message(10**10))
    assert found == []


def test_arguments_come_after_the_messages() -> None:
    first, second = SimpleFilter(), SimpleFilter()
    synchronizer = TimeSynchronizer([first, second], queue_size=2)
    calls: list[Any] = []
    assert synchronizer.registerCallback(lambda *words: calls.append(words), "a", 1) == 0
    assert synchronizer.registerCallback(lambda *words: calls.append(words)) == 1
    one, two = message(0), message(0)
    first.signalMessage(one)
    second.signalMessage(two)
    assert calls == [(one, two, "a", 1), (one, two)]
    assert message_filters.__all__


def test_the_executor_of_the_subscribers_runs_a_coroutine_function() -> None:
    """Upstream's never awaits it (message_filters#123)."""
    rclpy.init()
    node, sets = rclpy.create_node("fusion"), []
    subscribers = [message_filters.Subscriber(node, Header, topic) for topic in ("left", "right")]

    class Stamped(SimpleFilter):
        def add(self, header: Header) -> None:
            self.signalMessage(SimpleNamespace(header=header))

    stamped = [Stamped(), Stamped()]
    for subscriber, each in zip(subscribers, stamped, strict=True):
        subscriber.registerCallback(each.add)
    synchronizer = ApproximateTimeSynchronizer(stamped, 10, 0.1)
    future: Future = Future()

    async def fuse(*msgs: Any) -> None:
        await future
        sets.append(len(msgs))

    synchronizer.registerCallback(fuse)
    publishers = [node.create_publisher(Header, topic, 10) for topic in ("left", "right")]
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    for _ in range(500):
        if all(publisher.get_subscription_count() for publisher in publishers):
            break
        executor.spin_once(timeout_sec=0.02)
    for publisher in publishers:
        publisher.publish(Header())
    node.create_timer(0.1, lambda: future.set_result(None))
    for _ in range(500):
        if sets:
            break
        executor.spin_once(timeout_sec=0.02)
    assert sets[0] == 2
    rclpy.shutdown()


def test_a_coroutine_function_without_an_executor_is_refused() -> None:
    first, second = SimpleFilter(), SimpleFilter()
    synchronizer = TimeSynchronizer([first, second], 2)

    async def fuse(*_: Any) -> None: ...

    synchronizer.registerCallback(fuse)
    first.signalMessage(message(0))
    with pytest.raises(RuntimeError, match=r"no executor can run the coroutine function .*fuse"):
        second.signalMessage(message(0))

"""A network that loses, repeats, delays, parts and heals what passes; every run is the same."""

from __future__ import annotations

import time
from typing import Any

import pytest
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rmw_local import topic
from rmw_local.message import message_type
from rmw_local.transports import receipts, remote
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

from tests.rclpy.inside.contract.processes import DURABLE, Pair


@pytest.fixture
def pair(recorded: Pair) -> Pair:
    return recorded


def test_a_message_is_serialised_and_sent_once_for_all_of_its_subscriptions(
    pair: Pair,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    heard: list[str] = []
    for _ in range(3):
        other.create_subscription(String, "word", lambda message: heard.append(message.data), 10)
    one.create_subscription(String, "word", lambda message: heard.append(message.data), 10)
    kind = message_type(String)
    calls: list[Any] = []
    real = kind.serialize
    monkeypatch.setattr(kind, "serialize", lambda message: (calls.append(message), real(message))[1])
    publisher = one.create_publisher(String, "word", 10)
    assert publisher.get_subscription_count() == 4
    publisher.publish(String(data="word"))
    pair.until(lambda: len(heard) == 4)
    assert len(calls) == 1
    assert pair.network.log.count(("one", "put", "/word")) == 1


def test_what_stays_in_one_process_is_not_sent(pair: Pair) -> None:
    one, _ = pair.process("one").node, pair.process("two").node
    heard: list[str] = []
    one.create_subscription(String, "word", lambda message: heard.append(message.data), 10)
    publisher = one.create_publisher(String, "word", 10)
    publisher.publish(String(data="word"))
    pair.until(lambda: heard)
    assert ("one", "put", "/word") not in pair.network.log


def test_expired_messages_are_not_delivered(pair: Pair) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    heard: list[Any] = []
    other.create_subscription(Float64, "value", heard.append, 10)
    publisher = one.create_publisher(
        Float64, "value", QoSProfile(depth=5, lifespan=Duration(nanoseconds=1000))
    )
    pair.network.holds = True
    publisher.publish(Float64(data=0.1))
    time.sleep(0.001)
    pair.network.deliver()
    pair.settle()
    assert not heard


def test_a_partition_that_heals_leaves_nothing_behind(pair: Pair) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    heard: list[float] = []
    other.create_subscription(Float64, "state", lambda message: heard.append(message.data), DURABLE)
    publisher = one.create_publisher(Float64, "state", DURABLE)
    client = one.create_client(SetBool, "switch")
    other.create_service(SetBool, "switch", lambda _, response: response)
    publisher.publish(Float64(data=0.1))
    pair.until(lambda: heard == [0.1])
    whole = sorted(one.get_node_names()), one.get_topic_names_and_types()
    for round in range(3):
        pair.network.cut("one", "two")
        assert one.get_node_names() == ["one"]
        assert not client.service_is_ready()
        assert publisher.get_subscription_count() == 0
        publisher.publish(Float64(data=round + 0.5))
        pair.settle()
        pair.network.heal("one", "two")
        pair.until(lambda: heard[-1] == round + 0.5)  # noqa: B023 - seen at once
        assert (sorted(one.get_node_names()), one.get_topic_names_and_types()) == whole
    assert heard == [0.1, 0.5, 1.5, 2.5]
    future = client.call_async(SetBool.Request())
    pair.until(future.done)


@pytest.mark.parametrize("seed", range(3))
def test_what_comes_twice_is_answered_once_and_what_is_lost_is_not(pair: Pair, seed: int) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    asked: list[bool] = []
    client = one.create_client(SetBool, "switch")
    other.create_service(
        SetBool, "switch", lambda request, response: (asked.append(request.data), response)[1]
    )
    pair.until(client.service_is_ready)
    pair.network._random.seed(seed)
    pair.network.loss, pair.network.repetition = 0.3, 0.3
    futures = [client.call_async(SetBool.Request()) for _ in range(30)]
    for _ in range(100):
        pair.settle()
    done = sum(future.done() for future in futures)
    assert 0 < done <= len(asked) < 30


def test_subscriptions_elsewhere_come_and_go_without_a_change_to_the_route(pair: Pair) -> None:
    """Else each of thousands would cost as much as there are."""
    one, other = pair.process("one").node, pair.process("two").node
    publisher = one.create_publisher(Float64, "value", 10)
    one.create_subscription(Float64, "value", print, 10)
    (writer,) = pair.processes[0].domain.topics["/value"].writers
    alone, routes = writer._route, set()
    crowd = []
    for _ in range(20):
        crowd.append(other.create_subscription(Float64, "value", print, 10))
        routes.add(id(writer._route))
    assert publisher.get_subscription_count() == 21
    assert len(writer.readers) == 2  # the one of this process, and the way to others
    for subscription in crowd[1:]:
        other.destroy_subscription(subscription)
        routes.add(id(writer._route))
    assert len(routes) == 1
    other.destroy_subscription(crowd[0])
    assert (publisher.get_subscription_count(), writer._route) == (1, alone)


def test_who_is_elsewhere_does_not_meet_whom_else_is_elsewhere(
    pair: Pair, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half of a crowd may publish what the other half subscribes to."""
    domain, other = pair.process("one").domain, pair.process("two").node
    met: list[str] = []
    introduce = topic.Topic._introduce
    monkeypatch.setattr(
        topic.Topic,
        "_introduce",
        lambda self, *ends, newcomer: (met.append(self.name), introduce(self, *ends, newcomer=newcomer))[1],
    )
    for _ in range(3):
        other.create_publisher(Float64, "value", 10)
        other.create_subscription(Float64, "value", print, 10)
    assert (len([*domain.topics["/value"].writers]), met.count("/value")) == (
        3,
        9,
    )  # within the other process


def test_others_cannot_fill_the_graph(
    pair: Pair, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(remote, "_MOST_ENTITIES", 20)
    pair.process("one")
    other = pair.process("two").node
    for number in range(50):
        other.create_publisher(String, f"t{number}", 10)
    link = pair.processes[0].link
    assert len(link.others) == 20
    assert link.others.refused > 30
    assert capfd.readouterr().err.count("the rest is ignored") == 1
    link.close()
    assert not len(link.others)


def test_who_came_when_there_was_no_room_joins_in_turn(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remote, "_MOST_ENTITIES", 40)
    monkeypatch.setattr(remote, "_MOST_WAITING", 20)
    one, other = pair.process("one").node, pair.process("two").node
    publishers = {f"/t{number}": other.create_publisher(String, f"t{number}", 10) for number in range(80)}
    found = pair.processes[0].link.others

    def known() -> list[str]:
        return [name for name in publishers if one.count_publishers(name)]

    early = known()
    first, gone, third, *_ = waiting = [name for name in publishers if name not in early][:20]
    late = one.create_subscription(String, third, print, 10)
    other.destroy_publisher(publishers.pop(gone))
    assert (len(found), known(), late.get_publisher_count()) == (40, early, 0)
    for name in early[:2]:
        other.destroy_publisher(publishers.pop(name))
    assert (len(found), known(), late.get_publisher_count()) == (40, [*early[2:], first, third], 1)
    for name in early[2:]:
        other.destroy_publisher(publishers.pop(name))
    assert known() == [name for name in waiting if name != gone]


@pytest.mark.parametrize("reliability", [ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT])
def test_messages_that_are_lost_on_the_way_are_counted(pair: Pair, reliability: ReliabilityPolicy) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    qos = QoSProfile(depth=200, reliability=reliability)
    heard: list[tuple[float, int]] = []
    lost: list[tuple[int, int]] = []
    subscription = other.create_subscription(
        Float64,
        "value",
        lambda message, info: heard.append((message.data, info["publication_sequence_number"])),
        qos,
        event_callbacks=SubscriptionEventCallbacks(
            message_lost=lambda status: lost.append((status.total_count, status.total_count_change))
        ),
    )
    publishers = {data: one.create_publisher(Float64, "value", qos) for data in (0.1, 0.2)}

    def publish(*values: float) -> None:
        for data in values:
            publishers[data].publish(Float64(data=data))
        pair.until(
            lambda: (
                not subscription.handle.reader.unread and not subscription.handle.reader.message_lost.changed
            )
        )

    publish(0.1, 0.2)
    pair.network.loss, pair.network.repetition = 0.3, 0.3
    for _ in range(3):
        publish(*[0.1] * 20)
    pair.network.loss = 0
    publish(0.1, 0.2)
    assert len(heard) > len(set(heard)) > 4
    assert 1 < len(lost) <= 4
    assert lost[-1][0] == sum(change for _, change in lost) == 2 + 62 - len(set(heard))


def test_what_a_full_queue_or_a_partition_drops_is_not_lost(pair: Pair) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    lost: list[Any] = []
    events = SubscriptionEventCallbacks(message_lost=lost.append)
    heard: list[float] = []
    other.create_subscription(
        Float64, "value", lambda message: heard.append(message.data), 2, event_callbacks=events
    )
    publisher = one.create_publisher(Float64, "value", 10)
    for number in range(5):
        publisher.publish(Float64(data=number + 0.1))
    pair.settle()
    pair.network.cut("one", "two")
    publisher.publish(Float64(data=9.1))
    pair.network.heal("one", "two")
    publisher.publish(Float64(data=9.2))
    pair.settle()
    pair.until(lambda: len(heard) == 3)
    assert (heard, lost) == ([3.1, 4.1, 9.2], [])


def test_what_has_not_come_is_not_acknowledged(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(receipts, "_GIVES_UP", 0.01)
    one, other = pair.process("one").node, pair.process("two").node
    other.create_subscription(Float64, "value", print, 5)
    publisher = one.create_publisher(Float64, "value", 5)
    publisher.publish(Float64(data=0.1))
    pair.network.loss = 1
    publisher.publish(Float64(data=0.2))
    assert not publisher.wait_for_all_acked()  # it will never come
    pair.network.loss = 0
    publisher.publish(Float64(data=0.3))
    assert not publisher.wait_for_all_acked()  # one is missing
    for _ in range(5):
        publisher.publish(Float64(data=0.4))
    assert publisher.wait_for_all_acked()  # the missing one would be overwritten now
    pair.network.holds = True
    publisher.publish(Float64(data=0.5))
    assert not publisher.wait_for_all_acked(Duration(seconds=0.01))
    pair.network.holds = False
    pair.network.deliver()
    assert publisher.wait_for_all_acked(Duration(seconds=0))
    publisher.publish(Float64(data=0.6))
    pair.network.cut("one", "two")
    assert publisher.wait_for_all_acked()  # nobody is there


def test_who_knows_no_receipts_is_not_waited_for(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    one, other = pair.process("one").node, pair.process("two").node
    other.create_subscription(Float64, "value", print, 5)
    publisher = one.create_publisher(Float64, "value", 5)
    monkeypatch.setattr(pair.network.members["two"], "on_receipts", lambda _: None)
    publisher.publish(Float64(data=0.1))
    assert publisher.wait_for_all_acked()

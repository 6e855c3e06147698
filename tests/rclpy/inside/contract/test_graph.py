"""Who is there, who matches whom, and who is told of it."""

from __future__ import annotations

from typing import Any

import pytest
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rmw_local.message import MessageType
from rmw_local.qos import QosProfile
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

from tests.rclpy.inside.contract.processes import Pair


def test_the_graph_shows_both_processes(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    asked = QoSProfile(depth=7, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = one.create_publisher(String, "/space/word", asked)
    service = one.create_service(SetBool, "switch", lambda _, response: response)
    pair.until(lambda: other.count_publishers("/space/word") == 1 and other.count_services("/switch") == 1)
    pair.until(lambda: set(other.get_node_names()) == set(one.get_node_names()) == {"one", "two"})
    (info,) = other.get_publishers_info_by_topic("/space/word")
    assert (info.node_name, info.node_namespace, info.topic_type) == ("one", "/", "std_msgs/msg/String")
    assert str(info.topic_type_hash) == String.__type_hash__
    assert info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert ("/switch", ["std_srvs/srv/SetBool"]) in other.get_service_names_and_types_by_node("one", "/")
    one.destroy_publisher(publisher)
    one.destroy_service(service)
    pair.until(lambda: not other.count_publishers("/space/word") and not other.count_services("/switch"))
    assert "/space/word" not in dict(other.get_topic_names_and_types())
    pair.processes[0].leave()
    pair.until(lambda: other.get_node_names() == ["two"])


def test_matches_are_told(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    counts: list[tuple[int, int]] = []
    one.create_publisher(
        String,
        "word",
        10,
        event_callbacks=PublisherEventCallbacks(
            matched=lambda status: counts.append((status.current_count, status.current_count_change))
        ),
    )
    subscription = other.create_subscription(String, "word", print, 10)
    pair.until(lambda: counts)
    other.destroy_subscription(subscription)
    pair.until(lambda: len(counts) == 2)
    assert counts == [(1, 1), (0, -1)]


def test_incompatible_qos_keeps_endpoints_apart_and_both_are_told(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    told: list[str] = []
    heard: list[Any] = []
    offered = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    publisher = one.create_publisher(
        String,
        "word",
        offered,
        event_callbacks=PublisherEventCallbacks(incompatible_qos=lambda _: told.append("publisher")),
    )
    other.create_subscription(
        String,
        "word",
        heard.append,
        10,
        event_callbacks=SubscriptionEventCallbacks(incompatible_qos=lambda _: told.append("subscription")),
    )
    pair.until(lambda: set(told) == {"publisher", "subscription"})
    publisher.publish(String(data="word"))
    pair.settle()
    assert not heard
    assert publisher.get_subscription_count() == 0
    assert other.count_publishers("word") == 1


def test_a_publisher_is_alive_as_long_as_its_process_shows_it(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    changes: list[tuple[int, int]] = []
    qos = QoSProfile(depth=5, liveliness_lease_duration=Duration(seconds=100))
    other.create_subscription(
        String,
        "word",
        print,
        qos,
        event_callbacks=SubscriptionEventCallbacks(
            liveliness=lambda status: changes.append((status.alive_count, status.not_alive_count))
        ),
    )
    one.create_publisher(String, "word", qos)
    pair.until(lambda: changes == [(1, 0)])
    pair.processes[0].leave()
    pair.until(lambda: changes == [(1, 0), (0, 0)])


def test_a_publisher_that_says_it_is_alive_is_alive_elsewhere(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    changes: list[tuple[int, int]] = []
    qos = QoSProfile(
        depth=5, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=Duration(seconds=0.3)
    )
    other.create_subscription(
        String,
        "word",
        print,
        qos,
        event_callbacks=SubscriptionEventCallbacks(
            liveliness=lambda status: changes.append((status.alive_count, status.not_alive_count))
        ),
    )
    publisher = one.create_publisher(String, "word", qos)
    pair.until(publisher.get_subscription_count)
    pair.until(lambda: other.count_publishers("word"))
    publisher.assert_liveliness()
    pair.until(lambda: changes)
    assert changes == [(1, 0)]
    pair.until(lambda: len(changes) == 2)  # nothing more is said for 0.3 s
    assert changes[-1] == (0, 1)


def test_other_definitions_are_noticed_by_their_hashes(
    across: Pair, capfd: pytest.CaptureFixture[str]
) -> None:
    pair, one, other = across, across.process("one").node, across.process("two").node
    changed = MessageType(Float64)
    changed.type_hash = "RIHS01_" + "0" * 64
    log: list[str] = []
    reader = other.handle.graph_node.create_reader(changed, "/value", QosProfile())
    publisher = one.create_publisher(Float64, "value", 10)
    pair.until(reader.incompatible_type.is_ready)
    pair.until(lambda: other.count_publishers("value") == 1)
    publisher.publish(Float64(data=0.1))
    pair.settle()
    assert not reader.is_ready()
    assert publisher.get_subscription_count() == 0
    pair.until(lambda: log.append(capfd.readouterr().err) or "nothing is exchanged" in "".join(log))
    assert "topic '/value': /one (publisher) has another definition of std_msgs/msg/Float64" in "".join(log)
    assert "".join(log).count("[two]") == 1

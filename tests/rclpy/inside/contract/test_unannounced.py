"""Who knows keys only: bare sessions of Zenoh, without tokens."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from tests.rclpy.inside.contract.processes import Pair, connected

zenoh: Any = pytest.importorskip("zenoh")


@pytest.fixture
def pair() -> Iterator[Pair]:
    with connected("zenoh") as made:
        yield made


@pytest.fixture
def bare(pair: Pair) -> Iterator[tuple[Node, Any]]:
    """A node, and a session that knows nothing of ROS."""
    node = pair.process("one").node
    configuration = zenoh.Config()
    configuration.insert_json5("scouting/multicast/enabled", "false")
    configuration.insert_json5("listen/endpoints", "[]")
    configuration.insert_json5("connect/endpoints", f'["unixsock-stream/{pair.folder}/0"]')
    with zenoh.open(configuration) as session:
        yield node, session


def test_a_bare_subscriber_gets_messages_while_it_is_there(pair: Pair, bare: tuple[Node, Any]) -> None:
    node, session = bare
    publisher = node.create_publisher(String, "/said", 10)
    publisher.publish(String(data="to nobody"))
    came: list[bytes] = []
    subscriber = session.declare_subscriber(
        "*/said/**",
        zenoh.handlers.Callback(lambda sample: came.append(sample.payload.to_bytes()), indirect=False),
    )

    def said() -> list[bytes]:
        publisher.publish(String(data="0.1"))
        return came

    pair.until(said)
    assert came[0] == b"\0\1\0\0\4\0\0\x000.1\0"
    subscriber.undeclare()
    pair.until(lambda: _is_unheard(pair))
    assert publisher.get_subscription_count() == 0


def test_nobody_is_heard_within_the_process(pair: Pair, bare: tuple[Node, Any]) -> None:
    node, _ = bare
    got: list[String] = []
    node.create_subscription(String, "/said", got.append, QoSProfile(depth=1))
    publisher = node.create_publisher(String, "/said", 10)
    pair.settle()
    assert _is_unheard(pair)
    publisher.publish(String(data="0.1"))
    pair.until(lambda: got)


def _is_unheard(pair: Pair) -> bool:
    """Whether messages stay in the process."""
    return not any(writer.is_heard for writer in pair.processes[0].domain.topics["/said"].writers)

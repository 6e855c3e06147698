"""What `ifgen top` finds of nodes that run in the same process."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from ifgen_tools.session import Session, open_session
from ifgen_tools.top.collector import Collector
from ifgen_tools.top.snapshot import Snapshot
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rmw_local import statistics
from std_msgs.msg import String
from std_srvs.srv import Trigger

from tests.cli.conftest import Run

LIMIT = 10.0  # [s]


@pytest.fixture(autouse=True)
def _no_answer_is_that_of_the_last_test(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(statistics, "_FRESH", 0.0)


@pytest.fixture
def walker() -> Iterator[Node]:
    """A node that spins: it publishes words of 42 bytes, 4 of them in 20 ms, into a queue for 1."""
    rclpy.init(args=[])
    node = rclpy.create_node("walker", namespace="/robot")
    node.declare_parameter("speed", 0.1)
    node.declare_parameter("unset", Parameter.Type.DOUBLE)
    publisher = node.create_publisher(String, "word", 10)
    node.create_subscription(String, "word", lambda _: time.sleep(0.001), 1)
    node.create_service(Trigger, "reset", lambda _, response: response)

    def publish() -> None:
        for _ in range(4):
            publisher.publish(String(data="x" * 33))

    node.create_timer(0.02, publish)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield node
    executor.shutdown()
    thread.join(LIMIT)
    node.destroy_node()
    rclpy.shutdown()


@pytest.fixture
def session(walker: Node) -> Iterator[Session]:
    with open_session("local") as made:
        yield made


def looked(collector: Collector, seconds: float = 0.5) -> Snapshot:
    """What there is, with the rates of a moment."""
    collector.step()
    collector.spin(seconds)
    return collector.step()


def row(rows: Any, **wanted: Any) -> Any:
    (found,) = [each for each in rows if all(getattr(each, name) == value for name, value in wanted.items())]
    return found


def test_everything_that_is_there(session: Session) -> None:
    collector = Collector(session)
    collector.want(["/robot/word"])
    found = looked(collector)
    node = row(found.nodes)
    assert (node.name, node.publishers, node.subscriptions, node.clients) == ("/robot/walker", 3, 1, 0)
    assert node.process is not None
    topic = row(found.topics, name="/robot/word")
    assert topic.types == ("std_msgs/msg/String",)
    assert (topic.publishers, topic.subscriptions) == (("/robot/walker",), ("/robot/walker",))
    assert 100 < topic.rate < 300  # 200 on a machine with time
    assert topic.bandwidth == pytest.approx(topic.rate * 42)
    assert topic.missed > 0
    subscription = row(found.subscriptions, topic="/robot/word")
    assert (subscription.node, subscription.depth, subscription.lost) == ("/robot/walker", 1, 0)
    executor = row(found.executors)
    assert executor.nodes == ("/robot/walker",)
    assert 0 < executor.load < 1
    assert executor.longest >= 0.001
    assert row(found.services, name="/robot/reset").servers == ("/robot/walker",)
    assert found.silent == ()
    collector.close()


def test_it_listens_only_to_what_is_wanted_and_never_shows_itself(session: Session, walker: Node) -> None:
    collector = Collector(session)
    assert looked(collector, 0.1).nodes[0].subscriptions == 1
    assert walker.count_subscribers("/robot/word") == 1
    collector.want(["/robot/word", "/nobody"])
    collector.step()
    assert walker.count_subscribers("/robot/word") == 2
    found = looked(collector, 0.1)
    assert found.topics[1].subscriptions == ("/robot/walker",)
    collector.want([])
    collector.step()
    assert walker.count_subscribers("/robot/word") == 1
    quiet = Collector(session, listens=False)
    quiet.want(["/robot/word"])
    topic = row(looked(quiet, 0.2).topics, name="/robot/word")
    assert topic.rate > 0
    assert topic.bandwidth is None
    assert walker.count_subscribers("/robot/word") == 1


def test_parameters(session: Session) -> None:
    found = Collector(session).parameters("/robot/walker")
    assert found.problem == ""
    assert ("speed", "0.1") in found.values
    assert ("use_sim_time", "false") in found.values
    assert ("unset", "not set") in found.values  # and the others are shown nevertheless


def test_a_node_without_parameters(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ifgen_tools.top.collector._NODE_TAKES", 0.05)
    assert "has no services for its parameters" in Collector(session).parameters("/nobody").problem


def test_once(ifgen: Run, walker: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    def shown() -> str:
        return ifgen("top", "--once", "--transport", "local", "--period", "0.2").out

    text = shown()
    assert max(map(len, text.splitlines())) <= 80
    monkeypatch.delenv("COLUMNS")  # where nobody says how wide a line may be
    for word in ("/robot/word ", "/robot/walker ", "DROPPED", "LONGEST"):
        assert word in text
    assert "std_msgs/msg/String" in shown()
    assert "\x1b" not in text


def test_json(ifgen: Run, walker: Node) -> None:
    (line,) = ifgen(
        "top", "--once", "--json", "--transport", "local", "--period", "0.2", "--no-subscribe"
    ).out.splitlines()
    found = json.loads(line)
    assert [each["name"] for each in found["nodes"]] == ["/robot/walker"]
    assert found["topics"][1]["name"] == "/robot/word"
    assert found["topics"][1]["rate"] > 0

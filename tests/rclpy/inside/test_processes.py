"""What works within one process works between two: the same contract over each transport.

Two domains of this process stand for two processes; a transport connects them. Over the recording one everything
arrives at once, over Zenoh a little later.
"""

from __future__ import annotations

import itertools
import socket
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rmw_local.graph import Domain
from rmw_local.message import MessageType, message_type
from rmw_local.qos import QosProfile
from rmw_local.transports import environment, others
from rmw_local.transports.environment import Environment
from rmw_local.transports.link import Link
from rmw_local.transports.reach import Reach
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

from tests.rclpy.network import Network

zenoh = pytest.importorskip("zenoh")

LIMIT = 10.0  # [s] for what another thread does
_domains = itertools.count(1000)  # no test uses those


@dataclass
class Process:
    """A domain that stands for a process."""

    name: str
    node: Node
    executor: SingleThreadedExecutor
    link: Link


class Pair:
    """Two processes and what is between them."""

    def __init__(self, kind: str, folder: Path) -> None:
        self.kind = kind
        self.network = Network()
        self._folder = folder
        self._endpoints: list[str] = []
        self.reach = Environment()
        self.processes: list[Process] = []
        self._contexts: list[Context] = []

    def process(self, name: str) -> Process:
        """One more of them, with a node of this name."""
        domain = Domain.numbered(next(_domains))
        domain.reach = Reach(domain)  # never begun: nobody else is looked for
        context = Context()
        context.init(args=[], domain_id=domain.number, initialize_logging=False)
        node = Node(name, context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        link = Link(domain, self._transport(name))
        link.open()
        process = Process(name, node, executor, link)
        self.processes.append(process)
        self._contexts.append(context)
        return process

    def _transport(self, name: str) -> Any:
        if self.kind == "recorded":
            return self.network.join(name)
        from rmw_local.transports.zenoh.config import configuration
        from rmw_local.transports.zenoh.engine import ZenohTransport

        others = list(self._endpoints)
        endpoint = f"unixsock-stream/{self._folder}/{len(others)}"
        self._endpoints.append(endpoint)
        if self.reach.routers:
            return ZenohTransport(7, lambda: configuration(self.reach, [], []))
        return ZenohTransport(7, lambda: configuration(self.reach, [endpoint], others))

    def until(self, condition: Callable[[], Any]) -> None:
        """Spin everybody until it is so."""
        end = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < end, "it did not happen in time"
            for process in self.processes:
                process.executor.spin_once(timeout_sec=0.001)

    def settle(self) -> None:
        """Spin everybody for a moment, so that what should not arrive would have."""
        for _ in range(3 if self.kind == "recorded" else 40):
            for process in self.processes:
                process.executor.spin_once(timeout_sec=0.001)

    def end(self) -> None:
        for process in self.processes:
            process.executor.shutdown()
            process.node.destroy_node()
            process.link.close()
        for context in self._contexts:
            context.try_shutdown()


@pytest.fixture(params=["recorded", "zenoh"])
def pair(request: pytest.FixtureRequest) -> Iterator[Pair]:
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:  # sockets have short names
        made = Pair(request.param, Path(folder))
        yield made
        made.end()


@pytest.fixture
def two(pair: Pair) -> tuple[Pair, Node, Node]:
    return pair, pair.process("one").node, pair.process("two").node


def test_messages_pass_both_ways(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    heard: list[tuple[Any, Any]] = []
    echoes: list[float] = []
    back = other.create_publisher(Float64, "back", 10)
    other.create_subscription(
        Float64, "there", lambda m, info: (heard.append((m, info)), back.publish(m)), 10
    )
    one.create_subscription(Float64, "back", lambda message: echoes.append(message.data), 10)
    publisher = one.create_publisher(Float64, "there", 10)
    pair.until(lambda: publisher.get_subscription_count() == 1 and back.get_subscription_count() == 1)
    before = time.time_ns()
    for value in (0.1, -2.5, 1e300):
        publisher.publish(Float64(data=value))
    pair.until(lambda: len(echoes) == 3)
    assert echoes == [0.1, -2.5, 1e300]
    info = [info for _, info in heard]
    assert [each["publication_sequence_number"] for each in info] == [1, 2, 3]
    assert all(before <= each["source_timestamp"] <= each["received_timestamp"] for each in info)


def test_a_message_is_serialised_and_sent_once_for_all_of_its_subscriptions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pair = Pair("recorded", Path())
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
    pair.end()


def test_what_stays_in_one_process_is_not_sent() -> None:
    pair = Pair("recorded", Path())
    one, _ = pair.process("one").node, pair.process("two").node
    heard: list[str] = []
    one.create_subscription(String, "word", lambda message: heard.append(message.data), 10)
    publisher = one.create_publisher(String, "word", 10)
    publisher.publish(String(data="word"))
    pair.until(lambda: heard)
    assert ("one", "put", "/word") not in pair.network.log
    pair.end()


DURABLE = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_late_subscriptions_get_what_durable_publishers_have_kept(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    publisher = one.create_publisher(Float64, "state", DURABLE)
    for number in range(5):
        publisher.publish(Float64(data=number + 0.1))
    one.create_publisher(Float64, "later", 1)
    pair.until(lambda: other.count_publishers("later"))
    pair.settle()  # nothing is on its way any more
    late: list[float] = []
    volatile: list[float] = []
    other.create_subscription(Float64, "state", lambda message: late.append(message.data), DURABLE)
    other.create_subscription(Float64, "state", lambda message: volatile.append(message.data), 10)
    pair.until(lambda: len(late) == 3 and publisher.get_subscription_count() == 2)
    publisher.publish(Float64(data=9.5))
    pair.until(lambda: len(late) == 4 and volatile)
    pair.settle()
    assert late == [2.1, 3.1, 4.1, 9.5]
    assert volatile == [9.5]


def test_a_process_that_comes_later_gets_what_was_kept_before_there_was_a_link(pair: Pair) -> None:
    one = pair.process("one").node
    publisher = one.create_publisher(Float64, "state", DURABLE)
    pair.processes[0].link.close()
    publisher.publish(Float64(data=0.1))
    link = pair.processes[0].link = Link(one.handle.graph_node.participant.domain, pair._transport("one"))
    link.open()
    other = pair.process("two").node
    late: list[float] = []
    other.create_subscription(Float64, "state", lambda message: late.append(message.data), DURABLE)
    pair.until(lambda: late)
    assert late == [0.1]


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
    pair.processes[0].link.close()
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


def test_services_answer(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    client = one.create_client(SetBool, "switch")
    assert not client.service_is_ready()

    def answer(request: Any, response: Any) -> Any:
        response.success, response.message = request.data, "done"
        return response

    service = other.create_service(SetBool, "switch", answer)
    pair.until(client.service_is_ready)
    futures = [client.call_async(SetBool.Request(data=data)) for data in (True, False)]
    pair.until(lambda: all(future.done() for future in futures))
    assert [(future.result().success, future.result().message) for future in futures] == [
        (True, "done"),
        (False, "done"),
    ]
    other.destroy_service(service)
    pair.until(lambda: not client.service_is_ready())


def test_actions_reach_their_results(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two

    async def compute(goal: Any) -> Any:
        sequence = [0, 1]
        for _ in range(goal.request.order):
            sequence.append(sequence[-1] + sequence[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)

    server = ActionServer(
        other, Fibonacci, "compute", compute, cancel_callback=lambda _: CancelResponse.ACCEPT
    )
    client = ActionClient(one, Fibonacci, "compute")
    pair.until(client.server_is_ready)
    seen: list[int] = []
    sent = client.send_goal_async(
        Fibonacci.Goal(order=4), feedback_callback=lambda message: seen.append(len(message.feedback.sequence))
    )
    pair.until(sent.done)
    pair.until(lambda: len(seen) == 4)  # feedback that comes after the result is dropped, as upstream does
    result = sent.result().get_result_async()
    pair.until(result.done)
    assert list(result.result().result.sequence) == [0, 1, 1, 2, 3, 5]
    assert seen == sorted(seen)
    client.destroy()
    server.destroy()


def test_parameters_can_be_read_and_set(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    other.declare_parameter("rate", 0.1)
    client = AsyncParameterClient(one, "two")
    pair.until(client.services_are_ready)
    change = client.set_parameters([Parameter("rate", value=2.5)])
    pair.until(change.done)
    assert change.result().results[0].successful
    question = client.get_parameters(["rate"])
    pair.until(question.done)
    assert question.result().values[0].double_value == 2.5
    assert other.get_parameter("rate").value == 2.5


def test_only_the_newest_messages_wait_for_a_slow_subscription(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    heard: list[float] = []
    other.create_subscription(Float64, "fast", lambda message: heard.append(message.data), 5)
    done: list[Any] = []
    other.create_subscription(String, "done", done.append, 5)
    publisher, last = one.create_publisher(Float64, "fast", 5), one.create_publisher(String, "done", 5)
    pair.until(lambda: publisher.get_subscription_count() and last.get_subscription_count())
    reader = other.handle.graph_node.participant.domain.topics["/fast"].readers[0]
    for number in range(100):
        publisher.publish(Float64(data=float(number)))
    end = time.monotonic() + LIMIT
    while reader._queue[-1][2] != 100 if reader.unread else True:
        assert time.monotonic() < end
        time.sleep(0.001)
    pair.until(lambda: len(heard) == 5)
    assert heard == [95.0, 96.0, 97.0, 98.0, 99.0]


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
    pair.processes[0].link.close()
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
    two: tuple[Pair, Node, Node], capfd: pytest.CaptureFixture[str]
) -> None:
    pair, one, other = two
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


def test_expired_messages_are_not_delivered() -> None:
    pair = Pair("recorded", Path())
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
    pair.end()


def test_a_partition_that_heals_leaves_nothing_behind() -> None:
    pair = Pair("recorded", Path())
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
    pair.end()


@pytest.mark.parametrize("seed", range(3))
def test_what_comes_twice_is_answered_once_and_what_is_lost_is_not(seed: int) -> None:
    pair = Pair("recorded", Path())
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
    pair.end()


def test_others_cannot_fill_the_graph(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(others, "_MOST_ENTITIES", 20)
    pair = Pair("recorded", Path())
    pair.process("one")
    other = pair.process("two").node
    for number in range(50):
        other.create_publisher(String, f"t{number}", 10)
    link = pair.processes[0].link
    assert len(link.others) == 20
    assert link.others.refused > 30
    assert capfd.readouterr().err.count("the rest is ignored") == 1
    pair.end()
    assert not len(link.others)


def test_processes_meet_through_a_router() -> None:
    """As those on two machines do: each of them connects to the router, and none listens."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        place = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", f'["{place}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config):
        pair = Pair("zenoh", Path())
        pair.reach = environment.read({"ROS_STATIC_PEERS": place})
        one, other = pair.process("one").node, pair.process("two").node
        late: list[float] = []
        publisher = one.create_publisher(Float64, "state", DURABLE)
        publisher.publish(Float64(data=0.1))
        other.create_subscription(Float64, "state", lambda message: late.append(message.data), DURABLE)
        client = one.create_client(SetBool, "switch")
        other.create_service(SetBool, "switch", lambda _, response: response)
        pair.until(lambda: late == [0.1] and client.service_is_ready())
        assert pair.processes[0].link._transport.knows_router()
        future = client.call_async(SetBool.Request())
        pair.until(future.done)
        pair.end()


HOSTILE = ("@ros2_lv/7/abc/0/0/NN/%/%/a b", "@ros2_lv/7/abc/1/2/MP/%/%/x/%t", "@ros2_lv/7/xyz/0/0/QQ/%/%/n")


def test_hostile_peers_are_refused_and_counted() -> None:
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        pair = Pair("zenoh", Path(folder))
        process = pair.process("one")
        heard: list[Any] = []
        process.node.create_subscription(Float64, "value", heard.append, 10)
        config = zenoh.Config()
        config.insert_json5("scouting/multicast/enabled", "false")
        config.insert_json5("connect/endpoints", f'["unixsock-stream/{folder}/0"]')
        config.insert_json5("listen/endpoints", "[]")
        config.insert_json5("scouting/delay", "0")
        malformed = process.link._transport.malformed
        key = f"7/value/std_msgs::msg::dds_::Float64_/{Float64.__type_hash__}"
        with zenoh.open(config) as session:
            declared = [session.liveliness().declare_token(token) for token in HOSTILE]
            pair.until(lambda: malformed.count == len(HOSTILE))
            publisher = session.declare_publisher(key)
            pair.until(lambda: publisher.matching_status.matching)
            for attachment in (b"x", b"\0" * 34, b"\0" * 77, bytes(16) + b"\x20" + bytes(16)):
                publisher.put(b"\0\1\0\0" + bytes(8), attachment=attachment)
            pair.until(lambda: malformed.count == len(HOSTILE) + 4)
            assert not heard
            publisher.put(b"\0\1\0\0" + bytes(3), attachment=bytes(32))  # not a Float64
            publisher.put(b"\0\1\0\0" + bytes(8))  # no attachment: some tools send without
            pair.until(lambda: heard)
            assert heard == [Float64()]
            for each in declared:
                each.undeclare()
        assert process.node.get_node_names() == ["one"]
        pair.end()


def test_keep_all_is_kept(two: tuple[Pair, Node, Node]) -> None:
    pair, one, other = two
    everything = QoSProfile(history=HistoryPolicy.KEEP_ALL, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = one.create_publisher(Float64, "all", everything)
    for number in range(300):
        publisher.publish(Float64(data=float(number)))
    heard: list[float] = []
    other.create_subscription(Float64, "all", lambda message: heard.append(message.data), everything)
    pair.until(lambda: len(heard) == 300)
    assert heard == [float(number) for number in range(300)]

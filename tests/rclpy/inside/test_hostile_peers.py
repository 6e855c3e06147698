"""Sessions of Zenoh that are not ours, as they meet one of ours."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from typing import Any

import pytest
from rmw_local.transports import environment
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from tests.rclpy.inside.contract.processes import DURABLE, Pair, connected

zenoh = pytest.importorskip("zenoh")

HOSTILE = ("@ros2_lv/7/abc/0/0/NN/%/%/a b", "@ros2_lv/7/abc/1/2/MP/%/%/x/%t", "@ros2_lv/7/xyz/0/0/QQ/%/%/n")


@pytest.fixture
def pair() -> Iterator[Pair]:
    with connected("zenoh") as made:
        yield made


def test_processes_meet_through_a_router(pair: Pair) -> None:
    """As those on two machines do: each of them connects to the router, and none listens."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        place = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", f'["{place}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config):
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


def test_hostile_peers_are_refused_and_counted(pair: Pair) -> None:
    process = pair.process("one")
    heard: list[Any] = []
    process.node.create_subscription(Float64, "value", heard.append, 10)
    config = zenoh.Config()
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("connect/endpoints", f'["unixsock-stream/{pair.folder}/0"]')
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

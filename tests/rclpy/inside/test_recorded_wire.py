"""What rmw_zenoh_cpp itself sent, as others recorded it, replayed to our nodes; and that ours send the like.

Kilted: github.com/HK416/electric_sheep, tests/golden/ros2/rmw_zenoh/talker_capture.json: `ros2 run demo_nodes_cpp
talker` and `listener`, and `ros2 topic pub`, with ros-kilted-rmw-zenoh-cpp 0.6.6, by a bare session of Zenoh.
Jazzy: the tokens in docs/design.md of rmw_zenoh. Humble's are in test_wire.py.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import serialize_message
from rmw_local.domain import Domain
from rmw_local.message import message_type, service_type
from rmw_local.transports.discovery import Discovery
from rmw_local.transports.environment import Environment
from rmw_local.transports.interface import Kind
from rmw_local.transports.link import Link
from sensor_msgs.msg import JointState
from std_msgs.msg import String

pytest.importorskip("zenoh")

import zenoh
from rmw_local.transports.zenoh import attachments, tokens
from rmw_local.transports.zenoh.config import configuration
from rmw_local.transports.zenoh.engine import ZenohTransport

DOMAIN = 73
STRING = (
    "std_msgs::msg::dds_::String_/RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
)
TALKER, LISTENER = "a57729c4fcea9b446ceed53e32e5e6ab", "9f89b84f49800abbcdb946929ebd18d1"
KILTED = {
    "node": f"@ros2_lv/73/{TALKER}/0/0/NN/%/%/talker",
    "publisher": f"@ros2_lv/73/{TALKER}/0/10/MP/%/%/talker/%chatter/{STRING}/::,7:,:,:,,",
    "subscription": f"@ros2_lv/73/{LISTENER}/0/10/MS/%/%/listener/%chatter/{STRING}/::,10:,:,:,,",
}
ATTACHMENTS = [
    "010000000000000005620e9b201dd51810f7c771e2c442c54844d1d8a20eeb5914",
    "0200000000000000b81ca8d6201dd51810f7c771e2c442c54844d1d8a20eeb5914",
    "0300000000000000f7cc4212211dd51810f7c771e2c442c54844d1d8a20eeb5914",
]
PAYLOADS = [f"000100000f00000048656c6c6f20576f726c643a203{number}00" for number in (1, 2, 3)]
JOINTS = (
    "00010000000000000000000001000000005f726f02000000030000006a310000030000006a32000002000000"
    "000000000000e03f000000000000f0bf0000000000000000"
)
ADD_TWO_INTS = (
    "example_interfaces::srv::dds_::AddTwoInts_/"
    "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
)
JAZZY = {
    "node": "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener",
    "subscription": (
        f"@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/10/MS/%/%/listener/%chatter/{STRING}/::,10:,:,:,,"
    ),
    "publisher": f"@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/{STRING}/::,7:,:,:,,",
    "server": (
        "@ros2_lv/2/f9980ee0495eaafb3e38f0d19e2eae12/0/10/SS/%/%/add_two_ints_server/%add_two_ints/"
        f"{ADD_TWO_INTS}/::,10:,:,:,,"
    ),
    "client": (
        "@ros2_lv/2/e1dc8d1b45ae8717fce78689cc655685/0/10/SC/%/%/add_two_ints_client/%add_two_ints/"
        f"{ADD_TWO_INTS}/::,10:,:,:,,"
    ),
}


@pytest.mark.parametrize("token", [*KILTED.values(), *JAZZY.values()])
def test_tokens_are_read_and_written_without_a_difference(token: str) -> None:
    entity = tokens.read(token)
    domain, session = token.split("/")[1:3]
    assert tokens.write(int(domain), session, entity) == token
    kinds: dict[str, Any] = {"std_msgs/msg/String": message_type(String)}
    kinds["example_interfaces/srv/AddTwoInts"] = service_type(AddTwoInts)
    if entity.kind is not Kind.NODE:
        assert kinds[entity.type_name].type_hash == entity.type_hash


@pytest.mark.parametrize("number", [0, 1, 2])
def test_attachments_have_the_gid_of_their_publisher(number: int) -> None:
    data = bytes.fromhex(ATTACHMENTS[number])
    attachment = attachments.unpack(data)
    assert attachment.number == number + 1
    assert attachment.gid == tokens.gid_of(KILTED["publisher"])
    assert attachments.pack(*attachment) == data


def test_messages_are_the_same_bytes() -> None:
    for number, payload in enumerate(PAYLOADS, 1):
        assert serialize_message(String(data=f"Hello World: {number}")).hex() == payload
    ours = serialize_message(JointState(name=["j1", "j2"], position=[0.5, -1.0])).hex()
    assert ours == JOINTS.replace("5f726f", "000000")  # padding, which theirs leaves as it was in memory


@pytest.fixture
def beside() -> Iterator[tuple[Node, SingleThreadedExecutor, Any]]:
    """A node of ours in that domain, on Zenoh, and a session that replays."""
    domain = Domain.numbered(2000 + DOMAIN)
    domain.discovery = Discovery(domain)
    context = Context()
    context.init(args=[], domain_id=domain.number, initialize_logging=False)
    node, executor = Node("ours", context=context), SingleThreadedExecutor(context=context)
    executor.add_node(node)
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:  # sockets have short names
        endpoint = f"unixsock-stream/{folder}/0"
        link = Link(domain, ZenohTransport(DOMAIN, lambda: configuration(Environment(), [endpoint], [])))
        link.open()
        plain = zenoh.Config()
        plain.insert_json5("scouting/multicast/enabled", "false")
        plain.insert_json5("listen/endpoints", "[]")
        plain.insert_json5("connect/endpoints", f'["{endpoint}"]')
        with zenoh.open(plain) as session:
            yield node, executor, session
        executor.shutdown()
        node.destroy_node()
        link.close()
    rclpy.try_shutdown(context=context)


def test_a_recorded_talker_is_heard(beside: tuple[Node, SingleThreadedExecutor, Any]) -> None:
    node, executor, session = beside
    heard: list[tuple[str, Any]] = []
    callback: Any = lambda message, info: heard.append((message.data, info))  # noqa: E731 - it is one expression
    node.create_subscription(String, "chatter", callback, 10)
    declared = [session.liveliness().declare_token(token) for token in KILTED.values()]
    until(
        executor, lambda: node.count_publishers("/chatter") == 1 and node.count_subscribers("/chatter") == 2
    )
    assert {("talker", "/"), ("ours", "/")} <= set(node.get_node_names_and_namespaces())
    (talker,) = node.get_publishers_info_by_topic("/chatter")
    assert (talker.node_name, talker.topic_type) == ("talker", "std_msgs/msg/String")
    assert bytes(talker.endpoint_gid) == tokens.gid_of(KILTED["publisher"])
    publisher = session.declare_publisher(f"73/chatter/{STRING}")
    for payload, attachment in zip(PAYLOADS, ATTACHMENTS, strict=True):
        publisher.put(bytes.fromhex(payload), attachment=bytes.fromhex(attachment))
    until(executor, lambda: len(heard) == len(PAYLOADS))
    assert [text for text, _ in heard] == ["Hello World: 1", "Hello World: 2", "Hello World: 3"]
    stamps = [info["source_timestamp"] for _, info in heard]
    assert stamps == [attachments.unpack(bytes.fromhex(each)).stamp for each in ATTACHMENTS]
    for token in declared:
        token.undeclare()
    until(executor, lambda: node.count_publishers("/chatter") == 0)


def test_ours_send_the_like(beside: tuple[Node, SingleThreadedExecutor, Any]) -> None:
    node, executor, session = beside
    publisher = node.create_publisher(String, "chatter", 7)
    samples: list[tuple[bytes, bytes]] = []
    subscriber = session.declare_subscriber(
        f"73/chatter/{STRING}",
        zenoh.handlers.Callback(
            lambda sample: samples.append((sample.payload.to_bytes(), sample.attachment.to_bytes())),
            indirect=False,
        ),
    )

    def come() -> bool:
        publisher.publish(String(data="Hello World: 1"))
        return bool(samples)

    until(executor, come)
    replies = session.liveliness().get("@ros2_lv/73/**", timeout=5.0)
    keys = [str(reply.ok.key_expr) for reply in replies if reply.ok is not None]
    (token,) = [key for key in keys if "/MP/" in key and "/%chatter/" in key]
    payload, attachment = samples[0]
    assert payload.hex() == PAYLOADS[0]
    assert len(attachment) == len(bytes.fromhex(ATTACHMENTS[0]))
    assert attachments.unpack(attachment).gid == tokens.gid_of(token)
    assert token.split("/")[9:] == KILTED["publisher"].split("/")[9:]
    subscriber.undeclare()


def until(executor: SingleThreadedExecutor, condition: Any) -> None:
    """Spin until it is so."""
    for _ in range(1000):
        if condition():
            return
        executor.spin_once(timeout_sec=0.01)
    raise AssertionError("it did not happen in time")

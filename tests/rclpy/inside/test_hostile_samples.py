"""Whatever a session of Zenoh is sent is read, or refused and counted; it raises nothing on Zenoh's threads."""

from __future__ import annotations

import random
import struct
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from tests.rclpy.inside.contract.processes import Pair, Process, connected

zenoh = pytest.importorskip("zenoh")

CASES = 3000
HASH = Float64.__type_hash__
TOKEN = f"@ros2_lv/7/abc/1/2/MP/%/%/evil/%value/std_msgs::msg::dds_::Float64_/{HASH}/::,10:,:,:,,"
KEYS = (
    TOKEN,
    TOKEN.replace("MP", "MS"),
    f"@ifgen_lv/7/1/2/{TOKEN.partition('/7/')[2]}",
    "@ros2_lv/7/abc/0/0/NN/%/%/evil",
    f"@ros2_lv/7/abc/1/3/SS/%/%/evil/%switch/std_srvs::srv::dds_::SetBool_/{SetBool.__type_hash__}/::,10:,:,:,,",
    "@ifgen_lv/7",
    "@ifgen_calls/7/abc",
    "@ifgen_calls/7/me/abc",
    "@ifgen_alive/7/00ff",
    "7/value/x/y/ifgen_memory/me/abc",
    "",
)
PARTS = (
    "",
    "/",
    "%",
    "::",
    "\x1b]0;owned\x07",
    "\n",
    "é",
    "²",
    "9" * 30,
    "q" * 3000,
    "MP",
    "-1",
    "\0",
    "a b",
)
ATTACHMENTS = (
    None,
    b"",
    bytes(77),
    struct.pack("<qqB16s", -(2**63), 2**63 - 1, 16, b"g" * 16),
    struct.pack("<qqB16sB16s", 1, 1, 16, b"g" * 16, 0, b"s" * 16),
    struct.pack("<qqB16sB16s", 1, 1, 16, b"g" * 16, 255, b"s" * 16),
)
PAYLOADS = (b"", b"\0\1\0\0" + bytes(8), b"\0\1\0\0" + b"\xff" * 16, b"\xff\xfe\x1b[2J\n", bytes(5000))


class Payload(bytes):
    """Bytes as Zenoh hands them over."""

    def to_bytes(self) -> bytes:  # type: ignore[override]
        return bytes(self)

    def to_string(self) -> str:
        return self.decode()


class Query(SimpleNamespace):
    def reply(self, *_: Any, **__: Any) -> None: ...


@pytest.fixture(scope="module")
def pair() -> Iterator[Pair]:
    with connected("zenoh") as made:
        yield made


@pytest.fixture(scope="module")
def honest(pair: Pair) -> Process:
    """A process with one endpoint of each kind."""
    process = pair.process("honest")
    process.node.create_subscription(Float64, "value", lambda _: None, 3)
    process.node.create_publisher(Float64, "value", 3)
    process.node.create_service(SetBool, "switch", lambda _, response: response)
    process.node.create_client(SetBool, "switch")
    return process


def draw_key(drawn: random.Random) -> str:
    parts = drawn.choice(KEYS).split("/")
    for _ in range(drawn.randrange(3)):
        parts[drawn.randrange(len(parts))] = drawn.choice(PARTS)
    if not drawn.randrange(8):
        del parts[drawn.randrange(len(parts)) :]
    return "/".join(parts)


def draw_bytes(drawn: random.Random, of: tuple[bytes | None, ...]) -> Any:
    known = drawn.choice(of)
    if known is None:
        return None
    data = bytearray(known)
    for _ in range(drawn.randrange(3) if data else 0):
        data[drawn.randrange(len(data))] = drawn.randrange(256)
    return Payload(data)


def test_whatever_comes_is_refused_or_read(
    pair: Pair, honest: Process, capfd: pytest.CaptureFixture[str]
) -> None:
    assert honest.link is not None
    link = honest.link
    transport: Any = link._transport
    heard: list[Any] = []
    asked: list[Any] = []
    over: list[str] = []
    gid = b"g" * 16
    from rmw_local.transports.zenoh.services import Questions, Serving, _Query

    def got(*anything: Any) -> None:
        heard.append(anything)

    serving = Serving(transport._gate)
    questions = Questions(
        [], "/switch", transport._gate, transport._background, gid, got, got, lambda _, why: over.append(why)
    )

    def ask_and_hear(sample: Any) -> None:
        questions._open[1] = True
        query = _Query(questions, 1)
        sample.err = SimpleNamespace(payload=sample.payload)
        query(sample)
        query.end()

    calls: list[Callable[[Any], object]] = [
        lambda sample: transport._on_token(link._on_entity, sample),
        lambda sample: transport._on_alive(link._on_alive, sample),
        lambda sample: transport._on_question(link._on_receipts, sample),
        lambda sample: transport._on_sample(got, sample),
        lambda sample: transport._on_request(lambda *each: asked.append(each), serving, "7/switch", sample),
        lambda sample: transport._on_reply(got, gid, sample),
        transport._calls._on_process,
        transport._calls._on_message,
        transport._shared_memory._on_notice,
        transport._crowds._on_sample,
        ask_and_hear,
    ]
    drawn = random.Random(1)
    for number in range(CASES):
        sample = Query(
            key_expr=draw_key(drawn),
            kind=drawn.choice((zenoh.SampleKind.PUT, zenoh.SampleKind.DELETE)),
            payload=draw_bytes(drawn, (None, *PAYLOADS) if number % len(calls) in {2, 4} else PAYLOADS),
            attachment=draw_bytes(drawn, ATTACHMENTS),
            err=None,
        )
        sample.ok = drawn.choice((None, sample))
        calls[number % len(calls)](sample)
    assert transport.malformed.count > CASES / 10
    assert heard
    assert asked
    assert over
    with honest.domain.lock:
        link.others.remove_all()
    said = capfd.readouterr().err
    assert 0 < said.count("malformed") < 20
    for text in (said, *over):
        assert all(character.isprintable() or character == "\n" for character in text), text
    assert not any("\n" in why for why in over)
    heard.clear()
    other = pair.process("other")
    publisher = other.node.create_publisher(Float64, "value", 3)
    pair.until(publisher.get_subscription_count)

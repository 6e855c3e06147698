"""Whatever arrives from other processes is read, or refused and counted; it never raises where messages are taken.

`IFGEN_CASES` is the number of cases for each test; the slow tests have more of them.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ifgen.dynamic import class_from_text
from ifgen_runtime.codec import serialize
from ifgen_runtime.convert import from_dict
from ifgen_runtime.mismatch.reporting import Mismatch, Side, explanation
from ifgen_runtime.mismatch.type_description_client import Definitions, Question
from ifgen_runtime.type_description import describe
from rmw_local.qos import KEEP_LAST, QosProfile
from rmw_local.transports import reporter
from rmw_local.transports.interface import Entity, Kind
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool
from type_description_interfaces.msg import TypeDescription
from type_description_interfaces.srv import GetTypeDescription

from tests.rclpy.inside.contract.processes import Pair, Process, connected

POINT = "demo_msgs/msg/Point"
Mine = class_from_text(POINT, f"float32 x\nPart[] parts\n{'=' * 80}\nMSG: demo_msgs/Part\nstring name")
CASES = settings(
    max_examples=int(os.environ.get("IFGEN_CASES", "10")),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
int64 = st.integers(-(2**63), 2**63 - 1)
gids = st.binary(max_size=20)


@pytest.fixture(scope="module")
def pair() -> Iterator[Pair]:
    with connected("recorded") as made:
        yield made


@pytest.fixture(scope="module")
def honest(pair: Pair) -> Process:
    """A process with one endpoint of each kind."""
    process = pair.process("honest")
    process.node.create_subscription(Float64, "value", lambda _: None, 3)
    process.node.create_subscription(String, "words", lambda _: None, 3)
    process.node.create_publisher(Float64, "value", 3)
    process.node.create_service(SetBool, "switch", lambda _, response: response)
    process.node.create_client(SetBool, "switch")
    return process


def cdr(of: bytes) -> st.SearchStrategy[bytes]:
    """Bytes of all kinds: some are what is expected, some are that with a few changes."""

    def change(edits: list[tuple[int, bytes]]) -> bytes:
        data = bytearray(of)
        for place, new in edits:
            at = place % (len(data) + 1)
            data[at : at + len(new)] = new
        return bytes(data)

    edits = st.lists(
        st.tuples(st.integers(0, 1000), st.sampled_from([b"\xff", b"\0", b"\xff" * 4, b"\x80", b"x" * 5])),
        max_size=4,
    )
    return st.one_of(st.binary(max_size=60), edits.map(change), st.just(of[: len(of) // 2]))


messages = cdr(serialize(String(data="words")))
requests = cdr(serialize(SetBool.Request(data=True)))
entities = st.builds(
    Entity,
    kind=st.sampled_from(list(Kind)),
    node_id=st.integers(0, 3),
    entity_id=st.integers(0, 30),
    enclave=st.just("/"),
    namespace=st.sampled_from(("/", "/deep/er")),
    node=st.sampled_from(("evil", "honest")),
    name=st.sampled_from(("/value", "/words", "/switch", "/honest/get_parameters", "/new", "/rosout")),
    type_name=st.sampled_from(
        ("std_msgs/msg/Float64", "std_msgs/msg/String", "std_srvs/srv/SetBool", "a/msg/B")
    ),
    type_hash=st.sampled_from((Float64.__type_hash__, SetBool.__type_hash__, "", f"RIHS01_{'0' * 64}")),
    qos=st.builds(
        QosProfile, depth=st.integers(0, 10**9), lifespan=int64, deadline=st.integers(0, 2**62)
    ).map(lambda qos: replace(qos, history=KEEP_LAST)),
    peer=st.just("bad"),
    gid=gids,
    stands_in=st.booleans(),
    refuses=st.booleans(),
)
events = st.one_of(
    st.tuples(st.just("entity"), entities, st.booleans()),
    st.tuples(st.just("alive"), gids),
    st.tuples(st.just("message"), messages, int64, int64, gids),
    st.tuples(st.just("request"), requests, int64, int64, gids),
    st.tuples(st.just("reply"), requests, int64, int64),
)


def calls(process: Process) -> dict[str, list[Any]]:
    """All that a transport calls in a process."""
    link = process.link
    assert link is not None
    found: dict[str, list[Any]] = {"entity": [link._on_entity], "alive": [link._on_alive]}
    for presence in link._transport.entities.values():
        for kind, name in (("message", "_on_sample"), ("request", "_on_request"), ("reply", "on_reply")):
            if hasattr(presence, name):
                found.setdefault(kind, []).append(getattr(presence, name))
    return found


@given(st.lists(events, max_size=30))
@CASES
def test_whatever_a_transport_brings_leaves_no_trace(pair: Pair, honest: Process, brought: list[Any]) -> None:
    """Neither in the graph, once it is gone, nor in the memory; and spinning goes on."""
    link = honest.link
    assert link is not None
    before = sorted(honest.domain.topics), sorted(honest.domain.services), len(honest.domain.nodes)
    receivers = calls(honest)
    for kind, *arguments in brought:
        for call in receivers[kind]:
            call(*arguments)
    for _ in range(20):
        honest.executor.spin_once(timeout_sec=0)
    honest.node.get_node_names()
    honest.node.get_publishers_info_by_topic("/value")
    for gid in list(link.others._known):
        link._on_entity(replace(EVIL, gid=gid), False)
    pair.until(lambda: not link._reporter._is_reporting)
    assert len(link.others) == 0
    assert (sorted(honest.domain.topics), sorted(honest.domain.services), len(honest.domain.nodes)) == before


EVIL = Entity(Kind.NODE, 0, 0, "/", "/", "evil")
Response = GetTypeDescription.Response
TRUE = Response(successful=True, type_description=from_dict(TypeDescription, describe(Mine)))
names = st.one_of(
    st.sampled_from(
        (POINT, "demo_msgs/msg/Part", "", "a/b/c", "x" * 255, "\x1b[2J", "line\nbreak", "../../etc")
    ),
    st.sampled_from(("\u202e", "\x07", "é", "[]", "true")),
)
numbers = st.integers(0, 255)
lengths = st.sampled_from((0, 1, 3, 2**31, 2**64 - 1))
fields = st.fixed_dictionaries(
    {
        "name": names,
        "type": st.fixed_dictionaries(
            {"type_id": numbers, "capacity": lengths, "string_capacity": lengths, "nested_type_name": names}
        ),
        "default_value": names,
    }
)
individual = st.fixed_dictionaries({"type_name": names, "fields": st.lists(fields, max_size=5)})
documents = st.fixed_dictionaries(
    {"type_description": individual, "referenced_type_descriptions": st.lists(individual, max_size=4)}
)


@pytest.fixture(scope="module")
def connection(honest: Process) -> reporter._Connection:
    assert honest.link is not None
    return reporter._Connection(honest.domain, honest.link._transport)


@given(
    st.one_of(
        cdr(serialize(TRUE)),
        documents.map(
            lambda document: serialize(
                Response(successful=True, type_description=from_dict(TypeDescription, document))
            )
        ),
    )
)
@CASES
def test_whatever_a_node_says_of_its_definitions_is_explained_or_left_out(
    connection: reporter._Connection, answer: bytes
) -> None:
    question = Question("/evil", POINT, f"RIHS01_{'1' * 64}")
    definitions = Definitions(lambda: nullcontext(connection), lambda: False)
    definitions.keep(question, connection._response(answer))
    said = definitions.get(question)
    mine, theirs = (
        Side("/honest", "subscription", Mine.__type_hash__),
        Side("/evil", "publisher", question.type_hash, said),
    )
    text = explanation(Mismatch("topic", "/point", POINT, "warn", mine, theirs))
    assert 0 < len(text) < 20_000
    assert all(character.isprintable() or character == "\n" for character in text), text

"""The wire of rmw_zenoh: golden values, and whatever else may arrive."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rmw_local.qos import (
    AUTOMATIC,
    BEST_EFFORT,
    INFINITE,
    KEEP_ALL,
    KEEP_LAST,
    MANUAL_BY_TOPIC,
    RELIABLE,
    TRANSIENT_LOCAL,
    VOLATILE,
    QosProfile,
)
from rmw_local.transports import environment
from rmw_local.transports.environment import Environment
from rmw_local.transports.seam import Entity, Kind

pytest.importorskip("xxhash")

from rmw_local.transports.zenoh import attachments, keys, qos_text, tokens

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
SET_BOOL_HASH = "RIHS01_abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a"
RESOLVED = QosProfile(
    lifespan=INFINITE, deadline=INFINITE, liveliness=AUTOMATIC, liveliness_lease_duration=INFINITE
)
TALKER = f"@ros2_lv/0/abc1/0/3/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/{STRING_HASH}/::,10:,:,:,,"


def test_data_keys() -> None:
    assert (
        keys.data_key(7, "/ns1/chatter", "std_msgs/msg/String", STRING_HASH)
        == f"7/ns1/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"
    )
    assert (
        keys.data_key(0, "/add", "std_srvs/srv/SetBool", SET_BOOL_HASH)
        == f"0/add/std_srvs::srv::dds_::SetBool_/{SET_BOOL_HASH}"
    )
    assert keys.data_key(0, "/a", "p/msg/N", "").endswith("/TypeHashNotSupported")


@pytest.mark.parametrize(
    ("text", "changes"),
    [
        ("::,10:,:,:,,", {}),
        ("2::,5:,:,:,,", {"reliability": BEST_EFFORT, "depth": 5}),
        (":1:,1:,:,:,,", {"durability": TRANSIENT_LOCAL, "depth": 1}),
        ("::2,10:,:,:,,", {"history": KEEP_ALL}),
        ("::,10:0,500000000:,:,,", {"deadline": 500_000_000}),
        ("::,10:,:,:3,1,0", {"liveliness": MANUAL_BY_TOPIC, "liveliness_lease_duration": 10**9}),
        ("::,:,:,:,,", {"depth": 42}),
    ],
)
def test_qos_texts(text: str, changes: dict[str, int]) -> None:
    profile = QosProfile(
        **{
            "liveliness": 1,
            "lifespan": INFINITE,
            "deadline": INFINITE,
            "liveliness_lease_duration": INFINITE,
            **changes,
        }
    )  # type: ignore[arg-type]
    assert qos_text.write(profile) == text
    assert qos_text.read(text) == profile


def test_tokens_and_gids() -> None:
    entity = tokens.read(TALKER)
    assert entity == Entity(
        kind=Kind.PUBLISHER,
        node_id=0,
        entity_id=3,
        enclave="/",
        namespace="/",
        node="talker",
        name="/chatter",
        type_name="std_msgs/msg/String",
        type_hash=STRING_HASH,
        qos=RESOLVED,
        peer="abc1",
        gid=bytes.fromhex("880f5b508b937d755cd451690077296d"),
    )
    assert tokens.write(0, "abc1", entity) == TALKER
    assert tokens.session_of(TALKER) == "abc1"
    assert tokens.read(f"{TALKER}/buffer:cpu/more").qos == RESOLVED  # as newer ones append
    adapting = tokens.write(0, "abc1", replace(entity, stands_in=True))
    assert adapting == f"{TALKER}/ifgen_adapts"
    assert tokens.read(adapting).stands_in
    assert not entity.stands_in
    node = tokens.read("@ros2_lv/7/abc1/2/2/NN/%/%ns1%deep/talker")
    assert (node.kind, node.namespace, node.node) == (Kind.NODE, "/ns1/deep", "talker")
    humble = tokens.read(TALKER.replace(STRING_HASH, "TypeHashNotSupported"))
    assert humble.type_hash == ""


def test_attachments() -> None:
    golden = bytes.fromhex("050000000000000015cd5b070000000010000102030405060708090a0b0c0d0e0f")
    gid = bytes(range(16))
    assert attachments.pack(5, 123456789, gid) == golden
    assert attachments.unpack(golden) == (5, 123456789, gid)
    assert attachments.unpack(golden[:16] + gid) == (5, 123456789, gid)  # as newer ones are
    with pytest.raises(ValueError, match=r"rmw_zenoh 0\.2\.4"):
        attachments.unpack(bytes(77))


names = st.from_regex(r"(/[A-Za-z_][A-Za-z0-9_]{0,10}){1,4}", fullmatch=True)
words = st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,20}", fullmatch=True)
durations = st.one_of(st.just(INFINITE), st.integers(1, INFINITE))
profiles = st.builds(
    QosProfile,
    history=st.sampled_from((KEEP_LAST, KEEP_ALL)),
    depth=st.integers(1, 10**9),
    reliability=st.sampled_from((RELIABLE, BEST_EFFORT)),
    durability=st.sampled_from((VOLATILE, TRANSIENT_LOCAL)),
    lifespan=durations,
    deadline=durations,
    liveliness=st.sampled_from((AUTOMATIC, MANUAL_BY_TOPIC)),
    liveliness_lease_duration=durations,
)
endpoints = st.builds(
    Entity,
    kind=st.sampled_from([kind for kind in Kind if kind is not Kind.NODE]),
    node_id=st.integers(0, 2**31),
    entity_id=st.integers(0, 2**31),
    enclave=st.one_of(st.just("/"), names),
    namespace=st.one_of(st.just("/"), names),
    node=words,
    name=names,
    type_name=st.just("std_msgs/msg/String"),
    type_hash=st.just(STRING_HASH),
    qos=profiles,
)


@given(endpoints)
def test_every_entity_survives_its_token(entity: Entity) -> None:
    text = tokens.write(42, "beef", entity)
    read = tokens.read(text)
    assert (read.kind, read.node_id, read.entity_id) == (entity.kind, entity.node_id, entity.entity_id)
    assert (read.enclave, read.namespace, read.node) == (entity.enclave, entity.namespace, entity.node)
    assert (read.name, read.type_name, read.qos) == (entity.name, entity.type_name, entity.qos)


def _survives(read: object, data: object) -> None:
    """A parser returns something, or raises ValueError."""
    try:
        read(data)  # type: ignore[operator]
    except ValueError as error:
        assert len(str(error)) < 1000


@given(st.binary(max_size=100))
def test_any_bytes_are_an_attachment_or_one_error(data: bytes) -> None:
    _survives(attachments.unpack, data)


@given(st.one_of(st.text(max_size=60), st.text(alphabet="0123456789:,", max_size=40)))
def test_any_text_is_a_profile_or_one_error(text: str) -> None:
    _survives(qos_text.read, text)


@given(st.text(max_size=200))
def test_any_text_is_a_token_or_one_error(text: str) -> None:
    _survives(tokens.read, text)


@given(st.data())
def test_a_token_with_other_parts_is_a_token_or_one_error(data: st.DataObject) -> None:
    parts = TALKER.split("/")
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(parts) - 1))
        edit = data.draw(st.sampled_from(("replace", "remove", "repeat", "surrogate")))
        if edit == "replace":
            parts[place] = data.draw(st.text(max_size=30))
        elif edit == "surrogate":
            parts[place] += "\u0661\u00e9%%"
        elif edit == "repeat":
            parts[place] *= data.draw(st.sampled_from((2, 100)))
        elif len(parts) > 1:
            del parts[place]
    _survives(tokens.read, "/".join(parts))


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({}, Environment()),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, Environment()),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT"}, Environment()),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, Environment(subnet=True)),
        (
            {"ROS_STATIC_PEERS": "robot; 10.0.0.5:7448;fe80::1;[::1]:9;tls/robot:7447"},
            Environment(
                routers=(
                    "tcp/robot:7447",
                    "tcp/10.0.0.5:7448",
                    "tcp/[fe80::1]:7447",
                    "tcp/[::1]:9",
                    "tls/robot:7447",
                ),
                router_checks=1,
            ),
        ),
        (
            {"ZENOH_SESSION_CONFIG_URI": "/a/file.json5", "ZENOH_ROUTER_CHECK_ATTEMPTS": "0"},
            Environment(config_file="/a/file.json5", router_checks=environment.NO_END),
        ),
        (
            {"ZENOH_SESSION_CONFIG_URI": "/a/file.json5"},
            Environment(config_file="/a/file.json5", router_checks=1),
        ),
        ({"ZENOH_ROUTER_CHECK_ATTEMPTS": "3"}, Environment()),
        (
            {"ROS_STATIC_PEERS": "robot", "ZENOH_ROUTER_CHECK_ATTEMPTS": "-1"},
            Environment(routers=("tcp/robot:7447",)),
        ),
        (
            {"ZENOH_CONFIG_OVERRIDE": 'mode="client";scouting/delay=5'},
            Environment(overrides=(("mode", '"client"'), ("scouting/delay", "5"))),
        ),
    ],
)
def test_the_environment_says_how_far_to_reach(variables: dict[str, str], expected: Environment) -> None:
    assert environment.read(variables) == expected


@pytest.mark.parametrize(
    ("variables", "words"),
    [
        (
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "localhost"},
            "expected one of OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT",
        ),
        ({"ZENOH_CONFIG_OVERRIDE": "mode"}, "expected path/in/configuration=value"),
        (
            {"ROS_STATIC_PEERS": "robot", "ZENOH_ROUTER_CHECK_ATTEMPTS": "often"},
            "expected a whole number",
        ),
    ],
)
def test_what_is_wrong_in_the_environment_is_said_and_left_out(
    variables: dict[str, str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert not environment.read(variables).overrides
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line

"""The wire of rmw_zenoh: golden values, and whatever else may arrive."""

from __future__ import annotations

import string
from dataclasses import replace

import pytest
from hypothesis import given, settings
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
from rmw_local.transports.interface import Entity, Kind

pytest.importorskip("xxhash")

from rmw_local.transports.zenoh import attachments, inquiries, tokens

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
SET_BOOL_HASH = "RIHS01_abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a"
RESOLVED = QosProfile(
    lifespan=INFINITE, deadline=INFINITE, liveliness=AUTOMATIC, liveliness_lease_duration=INFINITE
)
TALKER = f"@ros2_lv/0/abc1/0/3/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/{STRING_HASH}/::,10:,:,:,,"


def test_data_keys() -> None:
    assert (
        tokens.data_key(7, "/ns1/chatter", "std_msgs/msg/String", STRING_HASH)
        == f"7/ns1/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"
    )
    assert (
        tokens.data_key(0, "/add", "std_srvs/srv/SetBool", SET_BOOL_HASH)
        == f"0/add/std_srvs::srv::dds_::SetBool_/{SET_BOOL_HASH}"
    )
    assert tokens.data_key(0, "/a", "p/msg/N", "").endswith("/TypeHashNotSupported")


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
    assert tokens.write_qos(profile) == text
    assert tokens.read_qos(text) == profile


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
    refusing = tokens.write(0, "abc1", replace(entity, refuses=True))
    assert refusing == f"{TALKER}/ifgen_refuses"
    assert tokens.read(refusing).refuses
    plain = tokens.read(TALKER)
    assert not (plain.stands_in or plain.refuses or plain.content_filter)
    node = tokens.read("@ros2_lv/7/abc1/2/2/NN/%/%ns1%deep/talker")
    assert (node.kind, node.namespace, node.node) == (Kind.NODE, "/ns1/deep", "talker")
    humble = tokens.read(TALKER.replace(STRING_HASH, "TypeHashNotSupported"))
    assert humble.type_hash == ""


DEEP = replace(
    RESOLVED,
    depth=1,
    reliability=BEST_EFFORT,
    durability=TRANSIENT_LOCAL,
    deadline=1_500_000_000,
    lifespan=2 * 10**9,
    liveliness=MANUAL_BY_TOPIC,
    liveliness_lease_duration=100_000_000,
)


@pytest.mark.parametrize(
    ("kind", "name", "type_name", "type_hash", "qos", "text"),
    [
        ("NN", "", "", "", RESOLVED, "2/2/NN/%/%ns1%deep/arm"),
        (
            "MP",
            "/ns1/state",
            "std_msgs/msg/String",
            STRING_HASH,
            DEEP,
            f"2/5/MP/%/%ns1%deep/arm/%ns1%state/std_msgs::msg::dds_::String_/{STRING_HASH}/2:1:,1:1,500000000:2,0:3,0,100000000",
        ),
        (
            "MS",
            "/chatter",
            "std_msgs/msg/String",
            "",
            replace(RESOLVED, history=KEEP_ALL, depth=0),
            "2/5/MS/%/%ns1%deep/arm/%chatter/std_msgs::msg::dds_::String_/TypeHashNotSupported/::2,:,:,:,,",
        ),
        (
            "SS",
            "/add",
            "std_srvs/srv/SetBool",
            SET_BOOL_HASH,
            RESOLVED,
            f"2/5/SS/%/%ns1%deep/arm/%add/std_srvs::srv::dds_::SetBool_/{SET_BOOL_HASH}/::,10:,:,:,,",
        ),
        (
            "SC",
            "/walk/_action/send_goal",
            "demo_msgs/action/Walk_SendGoal",
            SET_BOOL_HASH,
            RESOLVED,
            f"2/5/SC/%/%ns1%deep/arm/%walk%_action%send_goal/demo_msgs::action::dds_::Walk_SendGoal_/{SET_BOOL_HASH}/::,10:,:,:,,",
        ),
    ],
    ids=["node", "publisher", "subscription", "server", "client"],
)
def test_tokens_of_each_kind(
    kind: str, name: str, type_name: str, type_hash: str, qos: QosProfile, text: str
) -> None:
    number = 2 if kind == "NN" else 5
    entity = Entity(Kind(kind), 2, number, "/", "/ns1/deep", "arm", name, type_name, type_hash, qos)
    assert tokens.write(7, "abc1", entity) == f"@ros2_lv/7/abc1/{text}"
    read = tokens.read(f"@ros2_lv/7/abc1/{text}")
    assert (read.kind, read.name, read.type_name, read.type_hash) == (kind, name, type_name, type_hash)
    assert tokens.write(7, "abc1", read) == f"@ros2_lv/7/abc1/{text}"


def test_our_own_keys() -> None:
    assert tokens.alive_key(7, "0f" * 16) == f"@ifgen_alive/7/{'0f' * 16}"
    assert tokens.receipts_key(7, "abc1") == "@ifgen_receipts/7/abc1"
    assert tokens.data_key(
        0, "/walk/_action/feedback", "demo_msgs/action/Walk_FeedbackMessage", STRING_HASH
    ) == (f"0/walk/_action/feedback/demo_msgs::action::dds_::Walk_FeedbackMessage_/{STRING_HASH}")


def test_what_is_refused_is_quoted_shortly_and_without_control_characters() -> None:
    for place in range(2, 13):
        parts = TALKER.split("/")
        parts[place] = "\x1b[2J" + "q" * 1500
        try:
            tokens.read("/".join(parts))
        except ValueError as error:
            assert len(str(error)) < 200
            assert str(error).isprintable()


def test_what_a_real_publisher_of_rmw_zenoh_sent() -> None:
    """A token and an attachment of rmw_zenoh_cpp 0.1.8 on Humble, as dora-rs recorded them: one publisher."""
    token = (
        "@ros2_lv/0/9ca0f8facf84ffb1e6bfa4f2500889f0/0/3/MP/%/%/_ros2cli_712/%chatter/"
        "std_msgs::msg::dds_::String_/TypeHashNotSupported/:1:,1:,:,:,,"
    )
    attachment = bytes.fromhex("d80000000000000034dae10162f8c41810f07168d3856ce9f689254cbed6252151")
    entity = tokens.read(token)
    assert tokens.write(0, entity.peer, entity) == token
    number, stamp, gid = attachments.unpack(attachment)
    assert (number, stamp) == (216, 1784824452167621172)
    assert gid == entity.gid == tokens.gid_of(token)
    assert attachments.pack(number, stamp, gid) == attachment


def test_ids_in_tokens_may_be_any_words() -> None:
    """dora-rs 1.1.0 writes the name of the node."""
    session = "@ros2_lv/7/ae122512c58221b97211d32efcd3b360"
    node = tokens.read(f"{session}/dora_peer/1/NN/%/%/dora_peer")
    endpoint = tokens.read(f"{session}/dora_peer/2/MP/{TALKER.split('/MP/')[1]}")
    assert node.node_id == endpoint.node_id
    assert tokens.read(f"{session}/other/1/NN/%/%/dora_peer").node_id != node.node_id
    with pytest.raises(ValueError, match="does not belong"):
        tokens.read(f"{session}/a b/1/NN/%/%/dora_peer")


@pytest.mark.parametrize(
    "further",
    [
        "/cpu",  # Lyrical: the backends of an endpoint that takes buffers
        "/cpu;cuda:0/more",
    ],
)
def test_further_parts_of_a_token_change_its_gid_only(further: str) -> None:
    plain, longer = tokens.read(TALKER), tokens.read(TALKER + further)
    assert longer.gid != plain.gid
    assert replace(longer, gid=plain.gid) == plain


@pytest.mark.parametrize("wanted", [("a = %0 AND b LIKE 'ä/*%'", ("'x'",)), ("a = 1", ())])
def test_tokens_with_content_filters(wanted: tuple[str, tuple[str, ...]]) -> None:
    text = tokens.write(0, "abc1", replace(tokens.read(TALKER), content_filter=wanted))
    assert text.startswith(f"{TALKER}/ifgen_filter/")
    assert set(text[len(TALKER) :]) <= set("/-_") | set(string.ascii_letters + string.digits)
    assert tokens.read(text).content_filter == wanted
    long = tokens.write(0, "abc1", replace(tokens.read(TALKER), content_filter=("a" * 2000, ())))
    assert long == TALKER


@pytest.mark.parametrize("words", ["", "/", "/***", "/bm8", "/WzEsMl0", "/WyJhIixbMV1d", "/ifgen_filter"])
def test_filters_that_are_none(words: str) -> None:
    assert tokens.read(f"{TALKER}/ifgen_filter{words}").content_filter is None


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


@settings(max_examples=25)
@given(endpoints)
def test_every_entity_survives_its_token(entity: Entity) -> None:
    _survives_its_token(entity)


@pytest.mark.slow
@settings(max_examples=100)
@given(endpoints)
def test_many_entities_survive_their_tokens(entity: Entity) -> None:
    _survives_its_token(entity)


def _survives_its_token(entity: Entity) -> None:
    text = tokens.write(42, "beef", entity)
    read = tokens.read(text)
    assert (read.kind, read.node_id, read.entity_id) == (entity.kind, entity.node_id, entity.entity_id)
    assert (read.enclave, read.namespace, read.node) == (entity.enclave, entity.namespace, entity.node)
    assert (read.name, read.type_name, read.qos) == (entity.name, entity.type_name, entity.qos)


def _survives(read: object, data: object) -> None:
    """A parser returns something, or raises ValueError with what fits into a line of a terminal or two."""
    try:
        read(data)  # type: ignore[operator]
    except ValueError as error:
        assert len(str(error)) < 1100  # a hundred characters, each of which may be written as an escape
        assert str(error).isprintable()


@given(st.binary(max_size=100))
def test_any_bytes_are_an_attachment_or_one_error(data: bytes) -> None:
    _survives(attachments.unpack, data)


@given(st.binary(max_size=100))
def test_any_bytes_are_receipts_or_one_error(data: bytes) -> None:
    _survives(inquiries.unpack_receipts, data)
    whole = data[: len(data) // 32 * 32]
    assert inquiries.pack_receipts(inquiries.unpack_receipts(whole)) == whole


@given(st.one_of(st.text(max_size=60), st.text(alphabet="0123456789:,", max_size=40)))
def test_any_text_is_a_profile_or_one_error(text: str) -> None:
    _survives(tokens.read_qos, text)


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
            {
                "ROS_STATIC_PEERS": "robot; 10.0.0.5:7448;fe80::1;[::1]:9;tls/robot:7447;udp/r:1?rel=0#iface=lo;"
            },
            Environment(
                routers=(
                    "tcp/robot:7447",
                    "tcp/10.0.0.5:7448",
                    "tcp/[fe80::1]:7447",
                    "tcp/[::1]:9",
                    "tls/robot:7447",
                    "udp/r:1?rel=0#iface=lo",
                ),
                router_checks=1,
            ),
        ),
        ({"ROS_LOCALHOST_ONLY": "1"}, Environment()),
        (
            {"ROS_LOCALHOST_ONLY": "0", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"},
            Environment(subnet=True),
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


def test_who_is_private() -> None:
    """Requests go to processes of this user on this machine, so nobody can be kept from sending them."""
    private = [{}, {"ZENOH_CONFIG_OVERRIDE": "transport/link/tx/lease=600000"}]
    others = [
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"},
        {"ROS_STATIC_PEERS": "127.0.0.1"},
        {"ZENOH_SESSION_CONFIG_URI": "own.json5"},
        {"ZENOH_CONFIG_OVERRIDE": "access_control/enabled=true"},
        {"ZENOH_CONFIG_OVERRIDE": 'listen/endpoints=["tcp/[::]:0"]'},
        {"ZENOH_CONFIG_OVERRIDE": 'transport/link/protocols=["tcp"]'},
        {"ZENOH_CONFIG_OVERRIDE": 'transport={link:{protocols:["tcp"]}}'},
    ]
    assert all(environment.read(variables).is_private for variables in private)
    assert not any(environment.read(variables).is_private for variables in others)


NO_PEERS = (
    "a,b|a b|:7447|robot:|robot:x|robot:0|robot:65536|robot:²|robot/7447|tcp/robot|http/robot:80|tls/:7447"
)


@pytest.mark.parametrize("peer", NO_PEERS.split("|"))
def test_a_peer_that_no_network_has_is_left_out(peer: str, capsys: pytest.CaptureFixture[str]) -> None:
    found = environment.read({"ROS_STATIC_PEERS": f"robot;{peer}"})
    assert found.routers == ("tcp/robot:7447",)
    (line,) = capsys.readouterr().err.splitlines()
    assert f"ROS_STATIC_PEERS has {peer!r}, expected HOST, HOST:PORT or PROTOCOL/HOST:PORT" in line


@pytest.mark.parametrize(
    ("variables", "words"),
    [
        (
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "localhost"},
            "expected one of OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT",
        ),
        ({"ZENOH_CONFIG_OVERRIDE": "mode"}, "expected path/in/configuration=value"),
        ({"ROS_SECURITY_ENABLE": "true", "ROS_STATIC_PEERS": "robot"}, "there is no SROS 2 here: use TLS"),
        (
            {"ROS_LOCALHOST_ONLY": "1", "ROS_STATIC_PEERS": "robot"},
            "ROS_LOCALHOST_ONLY is 1, which comes before",
        ),
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

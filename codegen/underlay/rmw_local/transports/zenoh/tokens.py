"""Keys and liveliness tokens: the graph, a text for each node and each endpoint.

A topic's messages, and a service's requests and responses, have the key `<domain>/<name>/<type>/<hash>`.

A token is `@ros2_lv/<domain>/<session>/<node id>/<entity id>/<kind>/<enclave>/<namespace>/<node>`, and for
endpoints `/<name>/<type>/<hash>/<qos>`. What follows after that is newer than we are, and is ignored, but for
three words of our own. `/ifgen_adapts` ends a further token of a subscription or a server, with the hash of a
definition that it adapts. `/ifgen_refuses` ends the token of a client or a server that nobody is to adapt.
`/ifgen_filter/...` ends that of a subscription with a content filter, which follows as JSON in base64, unless
the token becomes too long.

A QoS profile is `reliability:durability:history,depth:deadline:lifespan:liveliness,lease`, durations as
`s,ns`. A value that equals rmw_zenoh's default is left out.
"""

from __future__ import annotations

import base64
import json
import re
from dataclasses import replace
from typing import Final

import xxhash

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
from rmw_local.transports.interface import Entity, Kind

NO_HASH: Final = "TypeHashNotSupported"
"""The hash of a type that has none, as on Humble."""

_DDS_TYPE: Final = re.compile(r"([A-Za-z]\w*)::(msg|srv|action)::dds_::([A-Za-z]\w*)_", re.ASCII)
_HASH: Final = re.compile(r"RIHS\d\d_[0-9a-f]{64}", re.ASCII)


def data_key(domain: int, name: str, type_name: str, type_hash: str) -> str:
    """The key that carries a topic's messages, or a service's requests and responses."""
    return f"{domain}/{name.strip('/')}/{dds_type(type_name)}/{type_hash or NO_HASH}"


def alive_key(domain: int, gid: str) -> str:
    """The key on which a publisher says that it is alive: ours. `gid` is in hexadecimal digits, or *."""
    return f"@ifgen_alive/{domain}/{gid}"


def receipts_key(domain: int, peer: str) -> str:
    """The key on which a process says what has come to its subscriptions: ours."""
    return f"@ifgen_receipts/{domain}/{peer}"


def settled_key(domain: int, peer: str) -> str:
    """The key of a token of ours that a process declares after all that was there; `peer` is * for all."""
    return f"@ifgen_settled/{domain}/{peer}"


def statistics_key(domain: int, peer: str) -> str:
    """The key on which a process answers questions for its statistics: ours. `peer` is *, for all."""
    return f"@ifgen_statistics/{domain}/{peer}"


def dds_type(type_name: str) -> str:
    """`pkg/msg/Name` as `pkg::msg::dds_::Name_`."""
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def ros_type(text: str) -> str:
    """The opposite of `dds_type`; raises ValueError."""
    found = _DDS_TYPE.fullmatch(text)
    if found is None:
        raise ValueError(f"{text[:100]!r} is not the name of a type")
    return "/".join(found.groups())


def hash_of(text: str) -> str:
    """A type hash, empty if the text says that there is none; raises ValueError."""
    if text == NO_HASH:
        return ""
    if _HASH.fullmatch(text) is None:
        raise ValueError(f"{text[:100]!r} is not a type hash")
    return text


_DEPTH: Final = 42
_SECOND: Final = 1_000_000_000  # [ns]
_DIGITS: Final = r"(\d{0,10})"
_QOS: Final = re.compile(
    ":".join(
        (
            r"(\d?)",
            r"(\d?)",
            rf"(\d?),{_DIGITS}",
            rf"{_DIGITS},{_DIGITS}",
            rf"{_DIGITS},{_DIGITS}",
            rf"(\d?),{_DIGITS},{_DIGITS}",
        )
    ),
    re.ASCII,
)


def write_qos(profile: QosProfile) -> str:
    """The text of a resolved profile."""
    reliability = _unless(profile.reliability, RELIABLE)
    durability = _unless(profile.durability, VOLATILE)
    history = _unless(profile.history, KEEP_LAST)
    depth = _unless(profile.depth or _DEPTH, _DEPTH)
    deadline, lifespan = _duration(profile.deadline), _duration(profile.lifespan)
    liveliness, lease = _unless(profile.liveliness, AUTOMATIC), _duration(profile.liveliness_lease_duration)
    return f"{reliability}:{durability}:{history},{depth}:{deadline}:{lifespan}:{liveliness},{lease}"


def read_qos(text: str) -> QosProfile:
    """The profile; raises ValueError for anything that no resolved profile could have."""
    found = _QOS.fullmatch(text)
    if found is None:
        raise ValueError(f"{text[:100]!r} is not a QoS profile")
    reliability, durability, history, depth, *durations = found.groups()
    deadline_s, deadline_ns, lifespan_s, lifespan_ns, liveliness, lease_s, lease_ns = durations
    return QosProfile(
        reliability=_one_of(reliability, RELIABLE, BEST_EFFORT),
        durability=_one_of(durability, VOLATILE, TRANSIENT_LOCAL),
        history=_one_of(history, KEEP_LAST, KEEP_ALL),
        depth=int(depth or _DEPTH),
        deadline=_nanoseconds(deadline_s, deadline_ns),
        lifespan=_nanoseconds(lifespan_s, lifespan_ns),
        liveliness=_one_of(liveliness, AUTOMATIC, MANUAL_BY_TOPIC),
        liveliness_lease_duration=_nanoseconds(lease_s, lease_ns),
    )


def _unless(value: int, default: int) -> str:
    return "" if value == default else str(value)


def _duration(duration: int) -> str:
    seconds, nanoseconds = divmod(duration or INFINITE, _SECOND)
    endless = divmod(INFINITE, _SECOND)
    return f"{_unless(seconds, endless[0])},{_unless(nanoseconds, endless[1])}"


def _nanoseconds(seconds: str, nanoseconds: str) -> int:
    """A duration [ns]; 0 means that none was set, and longer ones than rmw knows are endless."""
    endless = divmod(INFINITE, _SECOND)
    whole = int(seconds or endless[0]) * _SECOND + int(nanoseconds or endless[1])
    return min(whole or INFINITE, INFINITE)


def _one_of(text: str, default: int, other: int) -> int:
    value = int(text or default)
    if value not in {default, other}:
        raise ValueError(f"{value} is not a value of this policy")
    return value


_PREFIX: Final = "@ros2_lv"
_CROWD: Final = "@ifgen_lv"
_BRANCHES, _TWIGS = 8, 64
_STANDS_IN: Final = "ifgen_adapts"
_REFUSES: Final = "ifgen_refuses"
_FILTER: Final = "ifgen_filter"
_LONGEST: Final = 2048  # characters; names of ROS have at most 255
_NODE_PARTS, _ENDPOINT_PARTS = 9, 13
_KIND: Final = re.compile("|".join(Kind))
_SESSION: Final = re.compile(r"[0-9a-f]{1,32}", re.ASCII)
_ID: Final = re.compile(r"\w{1,255}", re.ASCII)
_PATH: Final = re.compile(r"/|(/[A-Za-z_]\w*)+", re.ASCII)
_NODE: Final = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def pattern(domain: int) -> str:
    """The key expression of all tokens of a domain."""
    return f"{_PREFIX}/{domain}/**"


def crowd_patterns(domain: int) -> list[str]:
    """The key expressions of those tokens of a domain that are declared below other keys.

    They are several, since Zenoh looks through all that matches one whenever there is more of it.
    """
    return [f"{_CROWD}/{domain}/{branch}/**" for branch in range(_BRANCHES)]


def in_crowd(token: str) -> str:
    """The key of a token among very many: Zenoh compares what has the same parts before it."""
    _, domain, rest = token.split("/", 2)
    gid = gid_of(token)
    return f"{_CROWD}/{domain}/{gid[0] % _BRANCHES}/{gid[1] % _TWIGS}/{rest}"


def of_key(key: str) -> str:
    """The token that is declared with a key."""
    parts = key.split("/", 4)
    return f"{_PREFIX}/{parts[1]}/{parts[4]}" if parts[0] == _CROWD and len(parts) == 5 else key


def write(domain: int, session: str, entity: Entity) -> str:
    """The token of an entity of the session with this id (hexadecimal)."""
    parts = [
        _PREFIX,
        str(domain),
        session,
        str(entity.node_id),
        str(entity.entity_id),
        entity.kind,
        *(_mangled(each) for each in (entity.enclave, entity.namespace, entity.node)),
    ]
    if entity.kind is not Kind.NODE:
        parts += [
            _mangled(entity.name),
            _mangled(dds_type(entity.type_name)),
            entity.type_hash or NO_HASH,
            write_qos(entity.qos),
        ]
        if entity.stands_in:
            parts.append(_STANDS_IN)
        if entity.refuses:
            parts.append(_REFUSES)
        if entity.content_filter is not None:
            text = base64.urlsafe_b64encode(json.dumps(entity.content_filter).encode()).decode()
            further = [_FILTER, text.rstrip("=")]
            if len("/".join([*parts, *further])) <= _LONGEST:
                parts += further
    return "/".join(parts)


def read(token: str) -> Entity:
    """The entity of a token, whoever sent it; raises ValueError for what is no token."""
    if len(token) > _LONGEST:
        raise ValueError("a token is too long")
    parts = token.split("/")
    if len(parts) < _NODE_PARTS:
        raise ValueError(f"{token[:100]!r} is not a token")
    prefix, _, session, node_id, entity_id, kind, enclave, namespace, node = parts[:_NODE_PARTS]
    if prefix != _PREFIX:
        raise ValueError(f"{token[:100]!r} is not a token")
    entity = Entity(
        kind=Kind(_must_match(_KIND, kind)),
        node_id=_number_of(node_id),
        entity_id=_number_of(entity_id),
        enclave=_must_match(_PATH, _demangled(enclave)),
        namespace=_must_match(_PATH, _demangled(namespace)),
        node=_must_match(_NODE, node),
        peer=_must_match(_SESSION, session),
        gid=gid_of(token),
    )
    if entity.kind is Kind.NODE:
        return entity
    if len(parts) < _ENDPOINT_PARTS:
        raise ValueError(f"{token[:100]!r} is not the token of an endpoint")
    name, type_name, type_hash, profile = parts[_NODE_PARTS:_ENDPOINT_PARTS]
    return replace(
        entity,
        name=_must_match(_PATH, _demangled(name)),
        type_name=ros_type(type_name),
        type_hash=hash_of(type_hash),
        qos=read_qos(profile),
        stands_in=_STANDS_IN in parts[_ENDPOINT_PARTS:],
        refuses=_REFUSES in parts[_ENDPOINT_PARTS:],
        content_filter=_filter_in(parts[_ENDPOINT_PARTS:]),
    )


def _filter_in(words: list[str]) -> tuple[str, tuple[str, ...]] | None:
    """The content filter that a token names; None for what is none: then everything is sent."""
    if _FILTER not in words[:-1]:
        return None
    text = words[words.index(_FILTER) + 1]
    try:
        found = json.loads(base64.urlsafe_b64decode(text + "=" * (-len(text) % 4)))
    except (ValueError, RecursionError):
        return None
    match found:
        case [str(expression), list(parameters)] if all(isinstance(each, str) for each in parameters):
            return expression, tuple(parameters)
    return None


def session_of(token: str) -> str:
    """The id of the session that a token belongs to; empty for what is no token."""
    parts = token.split("/", 3)
    return parts[2] if len(parts) == 4 else ""


def session_id(text: str) -> str:
    """The text, if it may be the id of a session; raises ValueError."""
    return _must_match(_SESSION, text)


def gid_of(token: str) -> bytes:
    """The gid of the entity with this token: 16 bytes, the low half of a hash before the high one."""
    number = xxhash.xxh3_128_intdigest(token.encode())
    return number.to_bytes(16, "little")


def _number_of(text: str) -> int:
    """An id as a number: rmw_zenoh counts, but reads any text, and dora-rs writes the name of the node."""
    if _must_match(_ID, text).isdecimal():
        return int(text)
    return xxhash.xxh3_64_intdigest(text.encode())


def _mangled(name: str) -> str:
    return name.replace("/", "%")


def _demangled(name: str) -> str:
    return name.replace("%", "/")


def _must_match(pattern: re.Pattern[str], text: str) -> str:
    if pattern.fullmatch(text) is None:
        raise ValueError(f"{text[:100]!r} does not belong into a token")
    return text

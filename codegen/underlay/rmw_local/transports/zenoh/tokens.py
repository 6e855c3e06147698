"""Liveliness tokens: the graph, a text for each node and each endpoint.

`@ros2_lv/<domain>/<session>/<node id>/<entity id>/<kind>/<enclave>/<namespace>/<node>`, and for endpoints
`/<name>/<type>/<hash>/<qos>`. What follows after that is newer than we are, and is ignored, but for two words
of our own. `/ifgen_adapts` ends a further token of a subscription or a server, with the hash of a definition
that it adapts. `/ifgen_refuses` ends the token of a client or a server that nobody is to adapt.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

import xxhash

from rmw_local.transports.seam import Entity, Kind
from rmw_local.transports.zenoh import qos_text
from rmw_local.transports.zenoh.keys import NO_HASH, dds_type, hash_of, ros_type

_PREFIX: Final = "@ros2_lv"
_CROWD: Final = "@ifgen_lv"
_BRANCHES, _TWIGS = 8, 64
_STANDS_IN: Final = "ifgen_adapts"
_REFUSES: Final = "ifgen_refuses"
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
            qos_text.write(entity.qos),
        ]
        if entity.stands_in:
            parts.append(_STANDS_IN)
        if entity.refuses:
            parts.append(_REFUSES)
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
        qos=qos_text.read(profile),
        stands_in=_STANDS_IN in parts[_ENDPOINT_PARTS:],
        refuses=_REFUSES in parts[_ENDPOINT_PARTS:],
    )


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

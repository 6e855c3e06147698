"""Names and types in Zenoh's keys: `<domain>/<name>/<type>/<hash>` for topics and services alike."""

from __future__ import annotations

import re
from typing import Final

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

"""The endpoints on a topic of DDS and their definitions: rclpy's infos as values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from ifgen_runtime.mismatch.real_rclpy.endpoints import Part

_UNKNOWN: Final = "_NODE_NAME_UNKNOWN_"
_KNOWN_HASH: Final = "RIHS01_"


@dataclass(frozen=True, slots=True)
class Peer:
    """Another endpoint. `type_hash` is empty where it tells none; `node` while its name is not known yet."""

    node: str
    type_hash: str
    gid: bytes


def peers(node: Any, part: Part) -> list[Peer]:
    """Those that a part of an endpoint of a node meets: on its topic, with a type of its name.

    Raises InvalidHandle where the node has been destroyed.
    """
    look = node.get_subscriptions_info_by_topic if part.written else node.get_publishers_info_by_topic
    wanted = part.type_name
    return [_peer(info) for info in look(part.topic, no_mangle=True) if _plain(info.topic_type) == wanted]


def differs(peer: Peer, part: Part) -> bool:
    """Whether the peer has another definition. One without a hash is not known to differ."""
    return bool(peer.type_hash) and peer.type_hash != part.type_hash


def _peer(info: Any) -> Peer:
    name = "" if info.node_name == _UNKNOWN else f"{info.node_namespace.rstrip('/')}/{info.node_name}"
    type_hash = str(info.topic_type_hash)
    known = type_hash if type_hash.startswith(_KNOWN_HASH) else ""
    return Peer(name, known, bytes(info.endpoint_gid))


def _plain(dds_type: str) -> str:
    """`my_msgs/msg/Speed` of `my_msgs::msg::dds_::Speed_`."""
    if "::" not in dds_type:
        return dds_type
    return dds_type.replace("::dds_::", "::").replace("::", "/").removesuffix("_")

"""The peers of an endpoint: who is on its topic of DDS, with which definition, and the policy about them."""

from __future__ import annotations

import threading
import time
import weakref
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final

from ifgen_runtime.adapters import adapter_for
from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.reporting import Lru
from ifgen_runtime.real_rclpy.endpoints import Part

_UNKNOWN: Final = "_NODE_NAME_UNKNOWN_"
_KNOWN_HASH: Final = "RIHS01_"
_ROS_TOPIC: Final = "rt/"

_FRESH: Final = 1_000_000
"""Nanoseconds for which a look at publishers holds while their number is the same: a look takes 15 us."""

_MOST_GONE: Final = 64
"""The definitions that are remembered after the last one who has them has left."""


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


def applied(policy: OnTypeMismatch, role: str, parts: Iterable[tuple[Part, str]]) -> OnTypeMismatch:
    """The policy for an endpoint that meets somebody, whose hashes of some parts are these.

    A publisher sends whatever others do. Actions are not adapted, and nothing is without an adapter.
    """
    if role == "publisher":
        return OnTypeMismatch.WARN
    if role.startswith("action"):
        return policy if policy is OnTypeMismatch.WARN else OnTypeMismatch.REFUSE
    if policy is OnTypeMismatch.ADAPT and not all(_can_adapt(part, type_hash) for part, type_hash in parts):
        return OnTypeMismatch.REFUSE
    return policy


def _can_adapt(part: Part, type_hash: str) -> bool:
    """Whether an adapter converts what goes over a part, in its direction."""
    if type_hash == part.type_hash:
        return True
    adapter = adapter_for(type_hash, part.cls)
    return adapter is not None and (not part.written or adapter.downgrade is not None)


class Others:
    """The definitions of those on one part of an endpoint that is guarded.

    The middleware puts an endpoint into the graph before it connects it. So whoever has sent something is in
    the graph, or has been.
    """

    def __init__(self, node: Any, part: Part) -> None:
        self.part = part
        self.hashes: frozenset[str] = frozenset()
        """Of all who were there at the last look. Those without a hash count as having ours."""
        self._node = weakref.ref(node)
        self._by_gid: Lru[str] = Lru()
        self._gone: dict[str, int] = {}  # when the last one with a definition had left [ns, system time]
        self._looked, self._counted = 0, -1  # when [ns], and how many publishers there were
        self._lock = threading.Lock()

    def see(self, found: Iterable[Peer]) -> frozenset[str]:
        """Take note of all who are there; returns their definitions."""
        by_gid = {peer.gid: peer.type_hash or self.part.type_hash for peer in found}
        for gid, type_hash in by_gid.items():
            self._by_gid.set(gid, type_hash)
        hashes = frozenset(by_gid.values())
        with self._lock:  # a thread looks, too
            for type_hash in self.hashes - hashes:
                self._gone.pop(type_hash, None)
                self._gone[type_hash] = time.time_ns()
            while len(self._gone) > _MOST_GONE:
                del self._gone[next(iter(self._gone))]
            self.hashes = hashes
        return hashes

    def look(self) -> frozenset[str]:
        """Take note of all who are there now. Raises InvalidHandle where the node has been destroyed."""
        node = self._node()
        return self.see(() if node is None else peers(node, self.part))

    def _look_again(self) -> frozenset[str]:
        """Take note of all who are there, unless the last look was just now and nobody has come."""
        node, topic, now = self._node(), self.part.topic, time.monotonic_ns()
        if node is None or self.part.written or not topic.startswith(_ROS_TOPIC):
            return self.look()
        count = node.handle.get_count_publishers(topic.removeprefix("rt"))
        if count == self._counted and now - self._looked < _FRESH:
            return self.hashes
        self._looked, self._counted = now, count
        return self.look()

    def hash_of(self, gid: bytes) -> str | None:
        """The definition of whoever has this gid; None if nobody has seen it."""
        if self._by_gid.get(gid) is None:
            self.look()
        return self._by_gid.get(gid)

    def senders_at(self, received: int) -> frozenset[str]:
        """The definitions of all who may have sent what was received then [ns, system time]."""
        now = self._look_again()
        with self._lock:
            return now | {type_hash for type_hash, left in self._gone.items() if received <= left}

    def differed_since(self, since: int) -> bool:
        """Whether somebody with another definition is there, or was after `since` [ns, system time]."""
        return bool(self.senders_at(since) - {self.part.type_hash})

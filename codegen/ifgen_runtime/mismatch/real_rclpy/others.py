"""The definitions of those whom a guarded endpoint meets, by gid, also of those who have left already."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable
from typing import Any, Final

from ifgen_runtime.mismatch.real_rclpy.endpoints import Part
from ifgen_runtime.mismatch.real_rclpy.graph import Peer, peers
from ifgen_runtime.mismatch.remembered import Remembered

SEVERAL: Final = "several definitions"
"""Instead of a hash: no adapter is for it, so it is refused."""


class Others:
    """Those on one part of an endpoint.

    The middleware puts an endpoint into the graph before it connects it. So whoever has sent something is in
    the graph, or has been.
    """

    def __init__(self, node: Any, part: Part, key: Callable[[bytes], bytes] = bytes) -> None:
        self.part = part
        self.hashes: frozenset[str] = frozenset()
        """Of all who are there. Those without a hash count as having ours: nobody can tell."""
        self._node = weakref.ref(node)
        self._key = key
        self._known: Remembered[frozenset[str]] = Remembered()

    def see(self, found: Iterable[Peer]) -> None:
        """Take note of all who are there."""
        by_key: dict[bytes, set[str]] = {}
        for peer in found:
            by_key.setdefault(self._key(peer.gid), set()).add(peer.type_hash or self.part.type_hash)
        for key, hashes in by_key.items():
            self._known.set(key, frozenset(hashes))
        self.hashes = frozenset[str]().union(*by_key.values())

    def look(self) -> None:
        """Take note of all who are there now. Raises InvalidHandle where the node has been destroyed."""
        node = self._node()
        self.see(() if node is None else peers(node, self.part))

    def hash_of(self, key: bytes) -> str | None:
        """The hash of whoever this is; None if nobody has seen it, and no hash at all if it has several."""
        known = self._known.get(key)
        if known is None:
            self.look()
            known = self._known.get(key) or frozenset()
        return next(iter(known), None) if len(known) <= 1 else SEVERAL

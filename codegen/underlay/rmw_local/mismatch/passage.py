"""Stand-ins for the receiving end of a connection, where its messages need care on their way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.mismatch.origin import Origin
    from rmw_local.service import ServiceEndpoint


class Marking:
    """Stands for a reader, a client or a server, and marks what it gets with its origin."""

    __slots__ = ("_origin", "end")
    is_remote = False

    def __init__(self, end: Any, origin: Origin) -> None:
        self.end = end
        self._origin = origin

    def accept(self, sample: tuple[Any, ...]) -> None:
        """Pass a message on."""
        self.end.accept((*sample, self._origin))

    def store(self, sample: tuple[Any, ...]) -> None:
        """Pass on what is only queued at first."""
        self.end.store((*sample, self._origin))

    def announce(self) -> None:
        """Pass on that something was queued."""
        self.end.announce()


class Downgrading:
    """Stands for a client or a server of another version, and converts to that before anything is sent."""

    __slots__ = ("_kind", "_node", "_origin", "end")
    is_remote = False

    def __init__(self, end: Any, origin: Origin, kind: MessageType, node: GraphNode) -> None:
        """`kind` is what `node` sends to the end, which is the peer of `origin`."""
        self.end = end
        self._origin = origin
        self._kind = kind
        self._node = node

    def accept(self, letter: tuple[bytes, int, bytes, int]) -> None:
        """Convert a request or a response and pass it on; if that fails, it is dropped and said once."""
        data = self._origin.downgraded(letter[0], self._kind, self._node)
        if data is not None:
            self.end.accept((data, *letter[1:]))


class Converting:
    """Stands for a client or a server of another version in another process, which `mine` adapts."""

    __slots__ = ("_mine", "_outgoing", "end", "incoming")
    is_remote = True

    def __init__(self, end: Any, incoming: Origin, outgoing: Origin, mine: ServiceEndpoint) -> None:
        """`incoming` marks what comes from the end; `outgoing` converts what goes there."""
        self.end = end
        self.incoming = incoming
        self._outgoing = outgoing
        self._mine = mine

    def downgraded(self, data: bytes) -> bytes | None:
        """A request or a response as the end reads it; None if that fails, which is said once."""
        return self._outgoing.downgraded(data, self._mine.sends, self._mine.node)

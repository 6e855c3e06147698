"""The duties of a transport: to announce endpoints, to carry bytes between them, and to tell who is there.

A transport knows names, QoS profiles and bytes, never messages. It calls back on its own threads; what it
calls only queues and wakes. Matching and QoS are not its business.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final, NamedTuple, Protocol

from rmw_local.qos import QosProfile

_NO_PROFILE: Final = QosProfile()  # of nodes


class Kind(StrEnum):
    """The kind of an entity, in the letters of rmw_zenoh."""

    NODE = "NN"
    PUBLISHER = "MP"
    SUBSCRIPTION = "MS"
    SERVER = "SS"
    CLIENT = "SC"


@dataclass(frozen=True, slots=True)
class Entity:
    """A node or an endpoint as it is announced.

    `node_id` and `entity_id` count within its process. `name` is the full name of the topic or service;
    `type_hash` is empty if there is none. `peer` is the id of its process, and `gid` its own (16 bytes): a
    transport fills them in. `stands_in` says that it is a further announcement of a subscription or a server,
    for another definition, whose messages it adapts. `refuses` says that a client or a server is not to be
    adapted: its node refuses other definitions. `content_filter` has expression and parameters of that of a
    subscription: a publisher need not send what no subscription accepts.
    """

    kind: Kind
    node_id: int
    entity_id: int
    enclave: str
    namespace: str
    node: str
    name: str = ""
    type_name: str = ""
    type_hash: str = ""
    qos: QosProfile = _NO_PROFILE
    peer: str = ""
    gid: bytes = b""
    stands_in: bool = False
    refuses: bool = False
    content_filter: tuple[str, tuple[str, ...]] | None = None


OnEntity = Callable[[Entity, bool], None]
"""Called when an entity of another process has appeared (True) or is gone (False)."""

OnSample = Callable[[bytes, int, int, bytes], None]
"""Called with a message, its number, its source stamp [ns] and its publisher's gid (empty if unknown)."""

Audience = Callable[[], Iterable[tuple[str, bytes]]]
"""Returns the process and the gid of each subscription elsewhere that a publisher reaches now."""

OnRequest = Callable[[bytes, int, int, bytes], None]
"""Called with a request, its number, its source stamp [ns] and its client's gid."""

OnReply = Callable[[bytes, int, int], None]
"""Called with a response, the number of its request and its source stamp [ns]."""

Ask = Callable[[bytes, int, int], None]
"""Sends a request, its number and its source stamp [ns] to all servers in other processes; raises nothing."""

OnOver = Callable[[int, str], None]
"""Called when no more response will come to the request of this number, at least not once the servers that
were asked have left the graph; with the reason, if none will come although they are there."""


class Receipt(NamedTuple):
    """The numbers by which a subscription says what it has got of a publisher."""

    gid: bytes
    """The subscription's."""
    last: int
    """The number of the last message that has come; 0 if none has."""
    newest_lost: int
    """The number of the newest message that has been lost; 0 if none has."""


OnReceipts = Callable[[bytes], list[Receipt]]
"""Called with a publisher's gid; returns the receipts of all its subscriptions in this process."""


OnQuestion = Callable[[], bytes]
"""Called when another process asks for statistics; returns those of this one (`rmw_local.statistics`)."""


class Presence(Protocol):
    """Something that is announced, until it is closed."""

    gid: bytes

    def close(self) -> None:
        """Withdraw it; what is in flight may be lost."""
        ...


class Publication(Presence, Protocol):
    """A publisher that is announced."""

    def put(self, data: bytes, number: int, stamp: int) -> None:
        """Send a message to all subscriptions in other processes; raises nothing."""
        ...

    def assert_alive(self) -> None:
        """Tell other processes that its publisher is alive, without a message."""
        ...

    def receipts(self, peer: str, patience: float) -> list[Receipt] | None:
        """Ask a process, behind all that was put, what has come to its subscriptions.

        Waits for the answer, for `patience` [s] at most; it is empty if none has come until then. None if
        that process does not answer such questions, or is gone.
        """
        ...

    def watch(self, on_listeners: Callable[[bool], None]) -> None:
        """Tell, once somebody listens in other processes, and when nobody does, also unannounced."""
        ...


class Asking(Presence, Protocol):
    """A client that is announced."""

    def ask(self, data: bytes, number: int, stamp: int, servers: Sequence[tuple[str, bytes]]) -> None:
        """Send a request to all servers in other processes; raises nothing, and does not wait.

        `servers` has the process and the gid of each that is known.
        """
        ...


class Serving(Presence, Protocol):
    """A server that is announced."""

    def reply(self, data: bytes, number: int, stamp: int, client: bytes) -> bool:
        """Answer a request of a client in another process; False if there is no such request."""
        ...

    def drop(self, number: int, client: bytes) -> None:
        """Leave such a request without a response."""
        ...


class Transport(Protocol):
    """One engine in one domain."""

    def open(self, on_entity: OnEntity, on_alive: Callable[[bytes], None]) -> None:
        """Join; `on_alive` gets the gid of each publisher that says it is alive. Raises TransportError."""
        ...

    def settle(self) -> None:
        """Tell others that all that was there when this process joined has been announced."""
        ...

    def acknowledge(self, on_receipts: OnReceipts) -> None:
        """Answer the questions of other processes for receipts."""
        ...

    def offer(self, on_question: OnQuestion) -> None:
        """Answer the questions of other processes for statistics."""
        ...

    def survey(self, patience: float) -> Callable[[], Iterable[bytes]]:
        """Ask all other processes for their statistics; raises nothing.

        Returns a function that returns what they have answered since the last call. Answers come for
        `patience` [s]. No thread of the transport calls back.
        """
        ...

    def announce(self, node: Entity) -> Presence:
        """Show a node to others."""
        ...

    def publish(self, publisher: Entity, audience: Audience) -> Publication:
        """Show a publisher to others, and keep what it sends for late joiners if its QoS says so.

        Its messages go to whoever listens. To an audience that is all nearby, there may be a shorter way.
        """
        ...

    def subscribe(self, subscription: Entity, on_sample: OnSample) -> Presence:
        """Show a subscription to others, and receive."""
        ...

    def ask(self, client: Entity, on_reply: OnReply, on_over: OnOver) -> Asking:
        """Show a client to others."""
        ...

    def ask_also(self, client: Entity, gid: bytes, on_reply: OnReply, on_over: OnOver) -> Ask:
        """Return what asks servers of another definition for the client that was shown with this gid.

        `client` has the hash of that definition. It is not shown.
        """
        ...

    def inquire(self, server: Entity, data: bytes, patience: float) -> Callable[[], Iterable[bytes]]:
        """Send one request to all servers of a service without being seen; raises nothing.

        Returns a function that returns what they have answered since the last call. Answers come for
        `patience` [s]. No thread of the transport calls back, so nothing is in the way of the program's end.
        """
        ...

    def serve(self, server: Entity, on_request: OnRequest) -> Serving:
        """Show a server to others, and receive requests."""
        ...

    def close(self) -> None:
        """Leave; everything that is announced is gone."""
        ...

"""The duties of a transport: to announce endpoints, to carry bytes between them, and to tell who is there.

A transport knows names, QoS profiles and bytes, never messages. It calls back on its own threads; what it
calls only queues and wakes. Matching and QoS are not its business.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Final, Protocol

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
    transport fills them in. `stands_in` says that it is the second announcement of a subscription, for the
    publishers of another definition, whose messages it adapts.
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


OnEntity = Callable[[Entity, bool], None]
"""Called when an entity of another process has appeared (True) or is gone (False)."""

OnSample = Callable[[bytes, int, int, bytes], None]
"""Called with a message, its number, its source stamp [ns] and its publisher's gid (empty if unknown)."""

OnRequest = Callable[[bytes, int, int, bytes], None]
"""Called with a request, its number, its source stamp [ns] and its client's gid."""

OnReply = Callable[[bytes, int, int], None]
"""Called with a response, the number of its request and its source stamp [ns]."""


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


class Asking(Presence, Protocol):
    """A client that is announced."""

    def ask(self, data: bytes, number: int, stamp: int) -> None:
        """Send a request to all servers in other processes; raises nothing, and does not wait."""
        ...


class Serving(Presence, Protocol):
    """A server that is announced."""

    def reply(self, data: bytes, number: int, stamp: int, client: bytes) -> bool:
        """Answer a request of a client in another process; False if there is no such request."""
        ...


class Transport(Protocol):
    """One engine in one domain."""

    def open(self, on_entity: OnEntity, on_alive: Callable[[bytes], None]) -> None:
        """Join; `on_alive` gets the gid of each publisher that says it is alive. Raises TransportError."""
        ...

    def announce(self, node: Entity) -> Presence:
        """Show a node to others."""
        ...

    def publish(self, publisher: Entity) -> Publication:
        """Show a publisher to others, and keep what it sends for late joiners if its QoS says so."""
        ...

    def subscribe(self, subscription: Entity, on_sample: OnSample) -> Presence:
        """Show a subscription to others, and receive."""
        ...

    def ask(self, client: Entity, on_reply: OnReply) -> Asking:
        """Show a client to others."""
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

"""The transport of a lockstep run: what is sent waits for the end of the round, with everything else."""

from __future__ import annotations

import itertools
import sys
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rmw_local.qos import TRANSIENT_LOCAL
from rmw_local.transports.interface import (
    Ask,
    Audience,
    Entity,
    Kind,
    OnEntity,
    OnOver,
    OnQuestion,
    OnReceipts,
    OnReply,
    OnRequest,
    OnSample,
    Receipt,
)

if TYPE_CHECKING:
    from rmw_local.lockstep.side import Side

Key = tuple[str, str, str]
"""The name of a topic or service, the name of its type, and the type's hash."""

Order = tuple[str, int, int, int]
"""The place among all that is delivered in one round; see `Side.place`."""

_PREFIX: Final = b"step"  # of gids; then the number of the process, and one of its own


class Item(NamedTuple):
    """Something on its way to other processes."""

    order: Order
    domain: int
    kind: str
    """Of what it is: "sample", "request", "reply" or "alive"."""
    key: Key
    gid: bytes
    """Of its publisher or client."""
    data: bytes
    number: int
    stamp: int
    to: bytes = b""
    """The only subscription that it is for; empty for all."""


def process_of(gid: bytes) -> int:
    """The number of the process that an entity is in."""
    return int.from_bytes(gid[4:8], "big")


class LockstepTransport:
    """A `rmw_local.transports.interface.Transport` in one domain of one process."""

    def __init__(self, side: Side, domain: int) -> None:
        self._side = side
        self._domain = domain
        self._numbers = itertools.count(1)
        self._known: dict[bytes, Entity] = {}  # of other processes
        self._far: defaultdict[Key, dict[bytes, int]] = defaultdict(dict)  # who takes it: processes by gid
        self._publications: dict[bytes, _Publication] = {}
        self._subscriptions: defaultdict[Key, dict[bytes, OnSample]] = defaultdict(dict)
        self._servers: defaultdict[Key, dict[bytes, OnRequest]] = defaultdict(dict)
        self._clients: defaultdict[bytes, dict[Key, OnReply]] = defaultdict(dict)

    def open(self, on_entity: OnEntity, on_alive: Callable[[bytes], None]) -> None:
        """Join."""
        self._on_entity, self._on_alive = on_entity, on_alive

    def close(self) -> None:
        """Leave; the side tells others when its process ends."""

    def settle(self) -> None:
        """Announce nothing: a round ends only after everybody has announced everything."""

    def acknowledge(self, on_receipts: OnReceipts) -> None:
        """Answer nobody: nothing that is sent gets lost, so nobody asks."""

    def offer(self, on_question: OnQuestion) -> None:
        """Answer nobody, as nobody outside the run sees it."""

    def survey(self, patience: float) -> Callable[[], Iterable[bytes]]:
        """Ask nobody: an answer that comes in real time would have no place in the run."""
        return tuple

    def announce(self, node: Entity) -> _Presence:
        """Show a node."""
        return _Presence(self, self._shown(node))

    def publish(self, publisher: Entity, audience: Audience) -> _Publication:
        """Show a publisher. There is one way for all messages, whoever the audience is."""
        entity = self._shown(publisher)
        publication = self._publications[entity.gid] = _Publication(self, entity, audience)
        return publication

    def subscribe(self, subscription: Entity, on_sample: OnSample) -> _Presence:
        """Show a subscription."""
        entity = self._shown(subscription)
        self._subscriptions[_key(entity)][entity.gid] = on_sample
        return _Presence(self, entity)

    def ask(self, client: Entity, on_reply: OnReply, on_over: OnOver) -> _Asking:
        """Show a client."""
        entity = self._shown(client)
        return _Asking(self, entity, self.ask_also(entity, entity.gid, on_reply, on_over))

    def ask_also(self, client: Entity, gid: bytes, on_reply: OnReply, on_over: OnOver) -> Ask:
        """Take the answers of the servers of another definition, too."""
        entity = replace(client, gid=gid)
        self._clients[gid][_key(entity)] = on_reply

        def ask(data: bytes, number: int, stamp: int) -> None:
            self.send("request", entity, data, number, stamp)
            on_over(number, "")  # what servers have sent arrives before they leave

        return ask

    def serve(self, server: Entity, on_request: OnRequest) -> _Serving:
        """Show a server."""
        entity = self._shown(server)
        self._servers[_key(entity)][entity.gid] = on_request
        return _Serving(self, entity)

    def inquire(self, server: Entity, data: bytes, patience: float) -> Callable[[], Iterable[bytes]]:
        """Ask nobody: an answer that comes in real time would have no place in the run."""
        return tuple

    # What the entities do

    def send(self, kind: str, entity: Entity, data: bytes, number: int, stamp: int) -> Item:
        """Send to whoever takes what this entity sends, wherever that is, when the round ends."""
        item = Item(
            self._side.place(full_name(entity)),
            self._domain,
            kind,
            _key(entity),
            entity.gid,
            data,
            number,
            stamp,
        )
        self._side.post(item)
        return item

    def reply(self, entity: Entity, data: bytes, number: int, stamp: int, client: bytes) -> bool:
        """Answer a client; False if it is not there."""
        if client not in self._known:
            return False
        place = self._side.place(full_name(entity))
        self._side.post(Item(place, self._domain, "reply", _key(entity), client, data, number, stamp))
        return True

    def hide(self, entity: Entity) -> None:
        """Tell others that an entity is gone."""
        key, gid = _key(entity), entity.gid
        tables: tuple[dict[bytes, Any] | None, ...]
        tables = self._publications, self._subscriptions.get(key), self._servers.get(key), self._clients
        for table in tables:
            if table is not None:
                table.pop(gid, None)
        self._side.tell(self._domain, entity, appeared=False)

    def _shown(self, entity: Entity) -> Entity:
        number = self._side.number
        gid = _PREFIX + number.to_bytes(4, "big") + next(self._numbers).to_bytes(8, "big")
        entity = replace(entity, peer=str(number), gid=gid)
        self._side.tell(self._domain, entity, appeared=True)
        return entity

    # What the side does

    def takers(self, item: Item) -> set[int]:
        """The processes that an item is for."""
        if item.kind == "reply":
            return {process_of(item.gid)}
        return set(self._far[item.key].values()) if item.key in self._far else set()

    def learn(self, entity: Entity, unsent: Iterable[Item]) -> list[Item]:
        """Get to know an entity of another process; returns what is sent to it of `unsent` and of earlier."""
        self._known[entity.gid] = entity
        if entity.kind not in (Kind.SUBSCRIPTION, Kind.SERVER):
            self._on_entity(entity, True)
            return []
        key, process = _key(entity), process_of(entity.gid)
        is_first = process not in self._far[key].values()  # otherwise its process gets what is unsent
        self._far[key][entity.gid] = process
        self._on_entity(entity, True)
        if entity.kind is Kind.SERVER:
            return []
        present = [item for item in unsent if item.domain == self._domain and item.key == key]
        missed = present if is_first else []
        if entity.qos.durability != TRANSIENT_LOCAL:
            return missed
        kept = (each.kept for each in self._publications.values() if each.key == key)
        earlier = [item for items in kept for item in items if item not in present]
        early = self._side.early
        return [item._replace(order=early(item.order), to=entity.gid) for item in earlier] + missed

    def unlearn(self, gid: bytes) -> None:
        """Let an entity of another process go."""
        entity = self._known.pop(gid, None)
        if entity is not None:
            if (known := self._far.get(_key(entity))) is not None:
                known.pop(gid, None)
            self._on_entity(entity, False)

    def unlearn_all(self, process: int) -> None:
        """Let all entities of a process go."""
        for gid in [each for each in self._known if process_of(each) == process]:
            self.unlearn(gid)

    def deliver(self, item: Item) -> None:
        """Hand over what has come."""
        data, number, stamp, gid = item.data, item.number, item.stamp, item.gid
        if item.kind == "sample":
            for subscription, on_sample in tuple(self._subscriptions.get(item.key, {}).items()):
                if item.to in (b"", subscription):
                    on_sample(data, number, stamp, gid)
        elif item.kind == "request":
            for on_request in tuple(self._servers.get(item.key, {}).values()):
                on_request(data, number, stamp, gid)
        elif item.kind == "reply":
            if (on_reply := self._clients.get(gid, {}).get(item.key)) is not None:
                on_reply(data, number, stamp)
        else:
            self._on_alive(gid)


class _Presence:
    def __init__(self, transport: LockstepTransport, entity: Entity) -> None:
        self.gid = entity.gid
        self._transport = transport
        self._entity = entity

    def close(self) -> None:
        self._transport.hide(self._entity)


class _Publication(_Presence):
    def __init__(self, transport: LockstepTransport, entity: Entity, audience: Audience) -> None:
        super().__init__(transport, entity)
        self.key = _key(entity)
        self._audience = audience
        keeps = entity.qos.durability == TRANSIENT_LOCAL
        self.kept: deque[Item] = deque(maxlen=entity.qos.queue_length if keeps else 0)

    def put(self, data: bytes, number: int, stamp: int) -> None:
        self.kept.append(self._transport.send("sample", self._entity, data, number, stamp))

    def assert_alive(self) -> None:
        self._transport.send("alive", self._entity, b"", 0, 0)

    def receipts(self, peer: str, patience: float) -> list[Receipt]:
        """Count what arrives when the round ends as received: nobody can wait for that within the round."""
        return [Receipt(gid, sys.maxsize, 0) for each, gid in self._audience() if each == peer]

    def watch(self, on_listeners: Callable[[bool], None]) -> None:
        pass  # everybody in a run is announced


class _Asking(_Presence):
    def __init__(self, transport: LockstepTransport, entity: Entity, ask: Ask) -> None:
        super().__init__(transport, entity)
        self._ask = ask

    def ask(self, data: bytes, number: int, stamp: int, servers: Sequence[tuple[str, bytes]]) -> None:
        self._ask(data, number, stamp)


class _Serving(_Presence):
    def reply(self, data: bytes, number: int, stamp: int, client: bytes) -> bool:
        return self._transport.reply(self._entity, data, number, stamp, client)

    def drop(self, number: int, client: bytes) -> None:
        pass  # no request is remembered


def _key(entity: Entity) -> Key:
    return entity.name, entity.type_name, entity.type_hash


def full_name(entity: Any) -> str:
    """The fully qualified name of the node that an entity belongs to."""
    return f"{entity.namespace.rstrip('/')}/{entity.node}"

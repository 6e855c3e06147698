"""Processes that share this one: a transport that records what passes, and fails in the ways that are asked for.

Deterministic: everything arrives within the call that sends it, or with `deliver` while `holds` is true. Losses and
repetitions follow a seed.
"""

from __future__ import annotations

import itertools
import random
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from rmw_local.qos import TRANSIENT_LOCAL
from rmw_local.transports.interface import (
    Ask,
    Audience,
    Entity,
    OnEntity,
    OnOver,
    OnQuestion,
    OnReceipts,
    OnReply,
    OnRequest,
    OnSample,
    Receipt,
)

Message = tuple[bytes, int, int]  # data, number, stamp


@dataclass
class Network:
    """The space between processes."""

    seed: int = 0
    loss: float = 0.0
    """The share of messages, requests and responses that are lost."""
    repetition: float = 0.0
    """The share of those that arrive twice."""
    holds: bool = False
    """Nothing arrives before `deliver`."""
    log: list[tuple[str, str, str]] = field(default_factory=list)
    """What was sent: (process, "put", "ask" or "reply", name)."""

    def __post_init__(self) -> None:
        self._random = random.Random(self.seed)
        self._held: deque[Callable[[], None]] = deque()
        self._cuts: set[frozenset[str]] = set()
        self.members: dict[str, RecordingTransport] = {}

    def join(self, name: str) -> RecordingTransport:
        """A process of its own."""
        return RecordingTransport(self, name)

    def deliver(self) -> None:
        """Let everything arrive that is held."""
        while self._held:
            self._held.popleft()()

    def cut(self, one: str, other: str) -> None:
        """Part two processes: for each, the other one is gone."""
        self._cuts.add(frozenset((one, other)))
        for here, there in ((one, other), (other, one)):
            self.members[here].lose_sight_of(self.members[there])

    def heal(self, one: str, other: str) -> None:
        """Let them see each other again."""
        self._cuts.discard(frozenset((one, other)))
        for here, there in ((one, other), (other, one)):
            self.members[here].see(self.members[there])
        for here, there in ((one, other), (other, one)):
            self.members[here].catch_up_on(self.members[there])

    def others(self, member: RecordingTransport) -> list[RecordingTransport]:
        """Everybody whom a process can reach."""
        return [
            other
            for name, other in self.members.items()
            if other is not member and frozenset((name, member.name)) not in self._cuts
        ]

    def send(self, arrive: Callable[[], None]) -> None:
        """Let something arrive: now or later, once, twice or never."""
        if self._random.random() < self.loss:
            return
        times = 2 if self._random.random() < self.repetition else 1
        for _ in range(times):
            if self.holds:
                self._held.append(arrive)
            else:
                arrive()


class RecordingTransport:
    """A `rmw_local.transports.interface.Transport`."""

    def __init__(self, network: Network, name: str) -> None:
        self.name = name
        self.network = network
        self.entities: dict[bytes, Presence] = {}
        self._gids = itertools.count(1)

    def open(self, on_entity: OnEntity, on_alive: Callable[[bytes], None]) -> None:
        self.on_entity, self.on_alive = on_entity, on_alive
        self.network.members[self.name] = self
        for other in self.network.others(self):
            self.see(other)

    def close(self) -> None:
        for presence in list(self.entities.values()):
            presence.close()
        self.network.members.pop(self.name, None)

    def settle(self) -> None:
        pass

    def acknowledge(self, on_receipts: OnReceipts) -> None:
        self.on_receipts = on_receipts

    def offer(self, on_question: OnQuestion) -> None:
        self.on_question = on_question

    def survey(self, patience: float) -> Callable[[], Iterable[bytes]]:
        answers = [other.on_question() for other in self.network.others(self)]
        return lambda: [answers.pop() for _ in tuple(answers)]

    def announce(self, node: Entity) -> Presence:
        return self._present(Presence(self, node))

    def publish(self, publisher: Entity, audience: Audience) -> Publication:
        return self._present(Publication(self, publisher))

    def subscribe(self, subscription: Entity, on_sample: OnSample) -> Subscription:
        presence = self._present(Subscription(self, subscription, on_sample))
        for other in self.network.others(self):
            presence.catch_up_on(other)
        return presence

    def ask(self, client: Entity, on_reply: OnReply, on_over: OnOver) -> Asking:
        return self._present(Asking(self, client, on_reply, on_over))

    def ask_also(self, client: Entity, gid: bytes, on_reply: OnReply, on_over: OnOver) -> Ask:
        asking = Asking(self, client, on_reply, on_over)
        asking.gid = gid
        return asking.ask

    def inquire(self, server: Entity, data: bytes, patience: float) -> Callable[[], list[bytes]]:
        answers: list[bytes] = []
        asking = Asking(self, server, lambda answer, *_: answers.append(answer), lambda *_: None)
        asking.gid = f"?{next(self._gids)}".encode().ljust(16, b"\0")
        asking.ask(data, 1, 0)
        return lambda: [answers.pop(0) for _ in range(len(answers))]

    def serve(self, server: Entity, on_request: OnRequest) -> Serving:
        return self._present(Serving(self, server, on_request))

    def see(self, other: RecordingTransport) -> None:
        for presence in other.entities.values():
            self.on_entity(presence.entity, True)

    def lose_sight_of(self, other: RecordingTransport) -> None:
        for presence in other.entities.values():
            self.on_entity(presence.entity, False)
            if isinstance(presence, Serving):
                presence.give_up(self)

    def catch_up_on(self, other: RecordingTransport) -> None:
        for presence in list(self.entities.values()):
            if isinstance(presence, Subscription):
                presence.catch_up_on(other)

    def reached(self, kind: type[Any], by: Presence) -> list[Any]:
        """What is there in other processes under the same name, type and hash."""
        return [
            presence
            for other in self.network.others(self)
            for presence in list(other.entities.values())
            if isinstance(presence, kind) and presence.key == by.key
        ]

    def _present(self, presence: Any) -> Any:
        gid = f"{self.name}-{next(self._gids)}".encode().ljust(16, b"\0")
        presence.gid = gid
        presence.entity = replace(presence.entity, gid=gid, peer=self.name)
        self.entities[gid] = presence
        for other in self.network.others(self):
            other.on_entity(presence.entity, True)
        return presence


class Presence:
    gid = b""

    def __init__(self, owner: RecordingTransport, entity: Entity) -> None:
        self.owner, self.entity = owner, entity

    @property
    def key(self) -> tuple[str, str, str]:
        return self.entity.name, self.entity.type_name, self.entity.type_hash

    def close(self) -> None:
        if self.owner.entities.pop(self.gid, None) is not None:
            for other in self.owner.network.others(self.owner):
                other.on_entity(self.entity, False)


class Publication(Presence):
    def __init__(self, owner: RecordingTransport, entity: Entity) -> None:
        super().__init__(owner, entity)
        self.kept: deque[Message] = deque(maxlen=entity.qos.queue_length)

    def put(self, data: bytes, number: int, stamp: int) -> None:
        self.owner.network.log.append((self.owner.name, "put", self.entity.name))
        self.kept.append((data, number, stamp))
        for subscription in self.owner.reached(Subscription, self):
            subscription.receive(self, (data, number, stamp))

    def receipts(self, peer: str, patience: float) -> list[Receipt] | None:
        """What a process has now; nothing while something is on its way, as if the answer waited behind it."""
        reached = {other.name: other for other in self.owner.network.others(self.owner)}
        if peer not in reached:
            return None
        if self.owner.network.holds:
            time.sleep(patience)
            return []
        return reached[peer].on_receipts(self.gid)

    def watch(self, on_listeners: Callable[[bool], None]) -> None:
        pass  # everybody here is announced

    def assert_alive(self) -> None:
        for other in self.owner.network.others(self.owner):
            other.on_alive(self.gid)


class Subscription(Presence):
    def __init__(self, owner: RecordingTransport, entity: Entity, on_sample: OnSample) -> None:
        super().__init__(owner, entity)
        self._on_sample = on_sample
        self._seen: set[tuple[bytes, int]] = set()

    def receive(self, publication: Publication, message: Message) -> None:
        self._seen.add((publication.gid, message[1]))
        self.owner.network.send(lambda: self._on_sample(*message, publication.gid))

    def catch_up_on(self, other: RecordingTransport) -> None:
        """Get what transient local publishers of another process have kept, but nothing twice."""
        if self.entity.qos.durability != TRANSIENT_LOCAL:
            return
        for publication in list(other.entities.values()):
            if (
                isinstance(publication, Publication)
                and publication.key == self.key
                and publication.entity.qos.durability == TRANSIENT_LOCAL
            ):
                for message in publication.kept:
                    if (publication.gid, message[1]) not in self._seen:
                        self.receive(publication, message)


class Asking(Presence):
    def __init__(self, owner: RecordingTransport, entity: Entity, on_reply: OnReply, on_over: OnOver) -> None:
        super().__init__(owner, entity)
        self.on_reply = on_reply
        self._on_over = on_over
        self._asked: dict[int, set[bytes]] = {}  # the servers that may yet answer, by request

    def ask(self, data: bytes, number: int, stamp: int, servers: Sequence[tuple[str, bytes]] = ()) -> None:
        self.owner.network.log.append((self.owner.name, "ask", self.entity.name))
        servers = self.owner.reached(Serving, self)
        self._asked[number] = {server.gid for server in servers}
        for server in servers:
            self.owner.network.send(lambda server=server: server.receive(self, data, number, stamp))

    def end(self, number: int, server: bytes) -> None:
        """Note that a server will not answer any more, or has done so."""
        asked = self._asked.get(number, set())
        asked.discard(server)
        if not asked and self._asked.pop(number, None) is not None:
            self._on_over(number, "")


class Serving(Presence):
    def __init__(self, owner: RecordingTransport, entity: Entity, on_request: OnRequest) -> None:
        super().__init__(owner, entity)
        self._on_request = on_request
        self._waiting: dict[tuple[bytes, int], Asking] = {}

    def receive(self, asking: Asking, data: bytes, number: int, stamp: int) -> None:
        if (asking.gid, number) not in self._waiting:  # an engine drops what comes twice
            self._waiting[asking.gid, number] = asking
            self._on_request(data, number, stamp, asking.gid)

    def reply(self, data: bytes, number: int, stamp: int, client: bytes) -> bool:
        asking = self._waiting.pop((client, number), None)
        if asking is None:
            return False
        self.owner.network.log.append((self.owner.name, "reply", self.entity.name))
        self.owner.network.send(lambda: (asking.on_reply(data, number, stamp), asking.end(number, self.gid)))
        return True

    def drop(self, number: int, client: bytes) -> None:
        asking = self._waiting.pop((client, number), None)
        if asking is not None:
            asking.end(number, self.gid)

    def give_up(self, client: RecordingTransport | None = None) -> None:
        """Leave requests unanswered: those of one process, or all."""
        for (gid, number), asking in list(self._waiting.items()):
            if client in {None, asking.owner}:
                del self._waiting[gid, number]
                asking.end(number, self.gid)

    def close(self) -> None:
        super().close()
        self.give_up()

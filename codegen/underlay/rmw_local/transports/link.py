"""The connection of a domain to the other processes in it, over one transport.

Local nodes and endpoints are announced. Those of others join the domain's graph as `remote` ones, so
matching, events, counts and questions about the graph treat all alike. Lock order: the link's before the
domain's. The transport is called with the domain's lock held only to put what was kept. What the transport
calls takes the domain's lock only.
"""

from __future__ import annotations

import _thread
import itertools
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from rmw_local import timing
from rmw_local.domain import Domain, endpoints
from rmw_local.graph import GraphNode, Participant
from rmw_local.reader import Reader, Sample
from rmw_local.ready import ReadySource
from rmw_local.service import ServiceClient, ServiceEndpoint, ServiceServer
from rmw_local.transports.background import Background
from rmw_local.transports.interface import Entity, Kind
from rmw_local.transports.remote import Adapted, Others, RemoteReader, RemoteWriter
from rmw_local.transports.reporter import Reporter
from rmw_local.transports.services import ShownClient, ShownServer
from rmw_local.writer import Writer

if TYPE_CHECKING:
    from rmw_local.message import MessageType, ServiceType
    from rmw_local.mismatch.encounter import Encounter
    from rmw_local.qos import QosProfile
    from rmw_local.transports.interface import Presence, Publication, Receipt, Transport

Local = GraphNode | Writer | Reader | ServiceEndpoint

_FAREWELL: Final = 2.0
"""Seconds that the end of a process waits for a warning that is being made."""


class Link:
    """A domain's connection; `open` it once."""

    def __init__(self, domain: Domain, transport: Transport) -> None:
        self.others = Others(domain)
        self._background = Background()
        self._reporter = Reporter(domain, transport, self._background)
        self._domain = domain
        self._transport = transport
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._closed = False
        self._ids = itertools.count()
        self._node_ids: dict[GraphNode, int] = {}
        self._presences: dict[Local, Presence] = {}
        self._adapted: dict[Reader, dict[str, Presence]] = {}  # by the hashes of other definitions

    def open(self) -> None:
        """Join: learn of the others, and announce everything that is there. Raises TransportError."""
        self._transport.open(self._on_entity, self._on_alive)
        self._transport.acknowledge(self._on_receipts)
        self._transport.offer(self._on_question)
        self._domain.link = self
        self._domain.close_pending()
        with self._domain.lock:
            local: list[Local] = [*self._domain.nodes, *endpoints(self._domain)]
        for entity in local:
            self.announce(entity)
        self._transport.settle()

    def close(self) -> None:
        """Leave: others see nothing of this process any more, nor it of them."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            self._presences.clear()
            self._adapted.clear()
        self._reporter.close()
        self._background.end(_FAREWELL)
        self._transport.close()
        self._domain.link = None
        with self._domain.lock:
            for endpoint in endpoints(self._domain):
                if isinstance(endpoint, Writer):
                    endpoint.attach(None)
                self._part(endpoint)
            changed = self.others.remove_all()
        _notify(changed)

    def forget(self) -> None:
        """Send nothing more by it in a forked process, where threads that are gone may hold any lock."""
        self._domain.link = None
        for endpoint in endpoints(self._domain):
            if isinstance(endpoint, Writer):
                endpoint.detach_in_fork()
            self._part(endpoint)

    def _part(self, endpoint: Writer | Reader | ServiceEndpoint) -> None:
        if isinstance(endpoint, ServiceClient | ServiceServer):
            endpoint.beyond = None
        if isinstance(endpoint, ServiceClient):
            endpoint.expect_nothing()

    def announce(self, entity: Local) -> None:
        """Show a node or an endpoint to others, unless that is done already, or none of their business."""
        if entity.is_remote or _participant(entity).keeps_to_itself:
            return
        with self._lock:
            if not (self._closed or entity.closed or entity in self._presences):
                self._presences[entity] = self._present(entity)

    def withdraw(self, entity: Local) -> None:
        """Show it no longer."""
        with self._lock:
            presence = self._presences.pop(entity, None)
            if isinstance(entity, GraphNode):
                self._node_ids.pop(entity, None)
            further = self._adapted.pop(entity, {}) if isinstance(entity, Reader) else {}
        for each in (presence, *further.values()):
            if each is not None:
                each.close()

    def show_anew(self, reader: Reader) -> None:
        """Show a subscription with its new content filter; what is on its way to the old one is lost."""
        with self._lock:
            is_shown = reader in self._presences
        if is_shown:
            self.withdraw(reader)
            with self._domain.lock:
                topic = self._domain.topics.get(reader.topic)
                for writer in topic.writers if topic else ():
                    if isinstance(writer, RemoteWriter):
                        writer.forget_arrivals(reader)
            self.announce(reader)

    def attend_to(self, encounters: Iterable[Encounter]) -> None:
        """Adapt, and tell of encounters across processes, later and on other threads."""
        encounters = list(encounters)
        adapting = [
            each for each in encounters if each.adapts and not _participant(each.mine).keeps_to_itself
        ]
        if any(_participant(each.mine).side for each in adapting):
            self._adapt(adapting)  # lockstep: others are to learn of it in the same round each time
        elif adapting:
            self._background.start(self._adapt, adapting)
        self._reporter.report(encounters)

    def _adapt(self, encounters: Iterable[Encounter]) -> None:
        """Receive what is addressed to other definitions. Clients send to these, and need no preparation."""
        for encounter in encounters:
            mine = encounter.mine
            if isinstance(mine, Reader | ServiceServer):
                self.announce(mine)  # which may be about to happen
                with self._lock:
                    if mine in self._presences:
                        self._show_again(mine, encounter)

    def _show_again(self, mine: Reader | ServiceServer, encounter: Encounter) -> None:
        type_hash = encounter.theirs.kind.type_hash
        described = replace(self._described(mine), content_filter=None)  # it filters what it has adapted
        entity = replace(described, type_hash=type_hash, stands_in=True)
        presence = self._presences[mine]
        if isinstance(presence, ShownServer) and encounter.converting is not None:
            presence.adapt(entity, encounter.converting)
        elif isinstance(mine, Reader) and type_hash not in self._adapted.get(mine, {}):
            further = self._transport.subscribe(entity, Adapted(self.others, encounter))
            self._adapted[mine] = {**self._adapted.get(mine, {}), type_hash: further}

    def survey(self, patience: float) -> Callable[[], Iterable[bytes]]:
        """Ask all other processes for their statistics; see `Transport.survey`."""
        return self._transport.survey(patience)

    # What leaves

    def _present(self, entity: Local) -> Presence:
        if isinstance(entity, GraphNode):
            return self._transport.announce(self._described(entity))
        if isinstance(entity, Writer):
            publication = self._transport.publish(self._described(entity), partial(_audience, entity))
            with self._domain.lock:
                entity.attach(_PublicationSink(publication))
            publication.watch(partial(self._on_listeners, entity))
            return publication
        if isinstance(entity, Reader):
            return self._transport.subscribe(self._described(entity), partial(self._on_sample, entity))
        if isinstance(entity, ServiceClient):
            on_over = partial(self._on_over, entity)
            return ShownClient(entity, self._described(entity), self._transport, on_over)
        assert isinstance(entity, ServiceServer)
        return ShownServer(entity, self._described(entity), self._transport)

    def _described(self, entity: Local) -> Entity:
        node = entity if isinstance(entity, GraphNode) else entity.node
        node_id = self._node_ids.get(node)
        if node_id is None:
            node_id = self._node_ids[node] = next(self._ids)
        describe = partial(Entity, enclave=node.enclave, namespace=node.namespace, node=node.name)
        if isinstance(entity, GraphNode):
            return describe(Kind.NODE, node_id, node_id)
        name, kind, qos = _interface_of(entity)
        is_of_service = isinstance(entity, ServiceEndpoint)
        wanted = entity.content_filter if isinstance(entity, Reader) else None
        return describe(
            _kind(entity),
            node_id,
            next(self._ids),
            name=name,
            type_name=kind.name,
            type_hash=kind.type_hash,
            qos=qos,
            refuses=is_of_service and node.on_type_mismatch == "refuse",
            content_filter=None if wanted is None else (wanted.expression, wanted.parameters),
        )

    # What arrives, on the transport's threads

    def _on_entity(self, entity: Entity, appeared: bool) -> None:
        with self._domain.lock:
            newcomer: Entity | None = entity
            changed: list[ReadySource] = []
            if not appeared:
                changed = self.others.remove(entity.gid)
                newcomer = self.others.take_next()
            if newcomer is not None:
                changed += self.others.add(newcomer)
            joined = None if newcomer is None else self.others.get(newcomer.gid)
        _notify(changed)
        if joined is not None and not isinstance(joined, GraphNode) and joined.encounters:
            encounters, joined.encounters = joined.encounters, ()
            self.attend_to(encounters)

    def _on_listeners(self, writer: Writer, are_there: bool) -> None:
        with self._domain.lock:
            writer.is_heard = are_there
            writer.settle_route()

    def _on_alive(self, gid: bytes) -> None:
        writer = self.others.get(gid)
        if isinstance(writer, RemoteWriter):
            writer.note_life()

    def _on_over(self, client: ServiceClient, number: int, reason: str) -> None:
        if self._closed or not client.expects(number):
            return  # who leaves is not told that others are gone
        with self._domain.lock:
            has_failed = client.give_up(number, reason)
        if has_failed:
            client.notify()

    def _on_receipts(self, gid: bytes) -> list[Receipt]:
        writer = self.others.get(gid)
        if not isinstance(writer, RemoteWriter):
            return []
        return [
            writer.receipt(reader, presence.gid)
            for reader in writer.local_readers
            for presence in (self._presences.get(reader), *self._adapted.get(reader, {}).values())
            if presence is not None
        ]

    def _on_question(self) -> bytes:
        from rmw_local import statistics  # late: hardly anybody asks

        return statistics.of(self._domain).answer()

    def _on_sample(self, reader: Reader, data: bytes, number: int, stamp: int, gid: bytes) -> None:
        now = timing.time_ns()
        writer = self.others.get(gid)
        if isinstance(writer, RemoteWriter):
            # Another definition has a subscription of its own (`Adapted`).
            is_matched = writer.kind.type_hash == reader.kind.type_hash and writer.reaches(reader)
            if not is_matched:
                return
            writer.note_arrival(reader, number)
            if stamp <= now - writer.qos.lifespan:
                return  # too old
            writer.note_life()
        # Otherwise nobody has announced this publisher: some tools send without.
        reader.accept((data, stamp, number, now, gid))


class _PublicationSink:
    """A publication as a `RemoteSink`."""

    def __init__(self, publication: Publication) -> None:
        self._put = publication.put
        self._ask = publication.receipts
        self.assert_alive: Callable[[], None] = publication.assert_alive

    def accept(self, sample: Sample) -> None:
        self._put(sample[0], sample[2], sample[1])

    store = accept

    def wait_until_received(self, writer: Writer, patience: int) -> bool:
        from rmw_local.transports.receipts import wait_for_receipts  # late: few programs wait

        return wait_for_receipts(writer, self._ask, patience)

    def announce(self) -> None:
        pass


def _audience(writer: Writer) -> list[tuple[str, bytes]]:
    return [
        (reader.peer, reader.gid)
        for reader in list(writer.remote_readers)
        if isinstance(reader, RemoteReader)
    ]


def _notify(changed: Iterable[ReadySource]) -> None:
    for source in dict.fromkeys(changed):
        source.notify()


def _participant(entity: Local) -> Participant:
    return entity.participant if isinstance(entity, GraphNode) else entity.node.participant


def _kind(endpoint: Writer | Reader | ServiceEndpoint) -> Kind:
    if isinstance(endpoint, Writer):
        return Kind.PUBLISHER
    if isinstance(endpoint, Reader):
        return Kind.SUBSCRIPTION
    return Kind.CLIENT if isinstance(endpoint, ServiceClient) else Kind.SERVER


def _interface_of(
    endpoint: Writer | Reader | ServiceEndpoint,
) -> tuple[str, MessageType | ServiceType, QosProfile]:
    if isinstance(endpoint, ServiceEndpoint):
        return endpoint.name, endpoint.service_type, endpoint.qos.writer
    return endpoint.topic, endpoint.message_type, endpoint.qos

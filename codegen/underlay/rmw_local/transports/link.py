"""The connection of a domain to the other processes in it, over one transport.

Local nodes and endpoints are announced. Those of others join the domain's graph as `remote` ones, so
matching, events, counts and questions about the graph treat all alike. Lock order: the link's before the
domain's. The transport is called with the domain's lock held only to put what was kept. What the transport
calls takes the domain's lock only.
"""

from __future__ import annotations

import _thread
import itertools
import threading
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from rmw_local import timing
from rmw_local.graph import Domain, GraphNode, Participant, endpoints
from rmw_local.reader import Reader, Sample
from rmw_local.ready import ReadySource
from rmw_local.service import Letter, ServiceClient, ServiceEndpoint, ServiceServer
from rmw_local.transports.others import Others
from rmw_local.transports.remote import RemoteWriter
from rmw_local.transports.seam import Entity, Kind
from rmw_local.transports.teller import Teller
from rmw_local.writer import Writer

if TYPE_CHECKING:
    from rmw_local.encounter import Encounter
    from rmw_local.message import MessageType, ServiceType
    from rmw_local.qos import QosProfile
    from rmw_local.transports.seam import Asking, Presence, Publication, Serving, Transport

Local = GraphNode | Writer | Reader | ServiceEndpoint


class Link:
    """A domain's connection; `open` it once."""

    def __init__(self, domain: Domain, transport: Transport) -> None:
        self.others = Others(domain)
        self._teller = Teller(domain, transport)
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
        self._domain.link = self
        self._domain.bury()
        with self._domain.lock:
            local: list[Local] = [*self._domain.nodes, *endpoints(self._domain)]
        for entity in local:
            self.announce(entity)

    def close(self) -> None:
        """Leave: others see nothing of this process any more, nor it of them."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            self._presences.clear()
            self._adapted.clear()
        self._teller.close()
        self._transport.close()
        self._part()

    def forget(self) -> None:
        """Do the same in a forked process, where the transport and all locks are somebody else's."""
        self._domain.lock = threading.Lock()
        self._part()

    def _part(self) -> None:
        self._domain.link = None
        with self._domain.lock:
            for endpoint in endpoints(self._domain):
                if isinstance(endpoint, Writer):
                    endpoint.attach(None)
                elif isinstance(endpoint, ServiceClient | ServiceServer):
                    endpoint.beyond = None
            changed = self.others.remove_all()
        _notify(changed)

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

    def attend_to(self, encounters: Iterable[Encounter]) -> None:
        """Receive what is adapted, and tell of encounters across processes, later and on other threads."""
        encounters = list(encounters)
        adapting = [
            each for each in encounters if each.adapts and not _participant(each.mine).keeps_to_itself
        ]
        if adapting:
            _thread.start_new_thread(self._adapt, (adapting,))
        self._teller.tell_of(encounters)

    def _adapt(self, encounters: Iterable[Encounter]) -> None:
        """Subscribe once more, to messages that are addressed to other definitions."""
        from rmw_local.transports.adapted import Adapted  # late: definitions hardly ever differ

        for encounter in encounters:
            adapted = Adapted(self.others, encounter)
            reader = adapted.reader
            with self._lock:
                known = self._adapted.get(reader, {})
                if self._closed or reader.closed or adapted.type_hash in known:
                    continue
                entity = replace(self._described(reader), type_hash=adapted.type_hash, stands_in=True)
                presence = self._transport.subscribe(entity, adapted)
                self._adapted[reader] = {**known, adapted.type_hash: presence}

    # What leaves

    def _present(self, entity: Local) -> Presence:
        if isinstance(entity, GraphNode):
            return self._transport.announce(self._described(entity))
        if isinstance(entity, Writer):
            publication = self._transport.publish(self._described(entity))
            with self._domain.lock:
                entity.attach(_Outlet(publication))
            return publication
        if isinstance(entity, Reader):
            return self._transport.subscribe(self._described(entity), partial(self._on_sample, entity))
        if isinstance(entity, ServiceClient):
            asking = self._transport.ask(self._described(entity), partial(_on_reply, entity))
            entity.beyond = partial(_ask, asking)
            return asking
        assert isinstance(entity, ServiceServer)
        serving = self._transport.serve(self._described(entity), partial(_on_request, entity))
        entity.beyond = partial(_reply, serving)
        return serving

    def _described(self, entity: Local) -> Entity:
        node = entity if isinstance(entity, GraphNode) else entity.node
        node_id = self._node_ids.get(node)
        if node_id is None:
            node_id = self._node_ids[node] = next(self._ids)
        describe = partial(Entity, enclave=node.enclave, namespace=node.namespace, node=node.name)
        if isinstance(entity, GraphNode):
            return describe(Kind.NODE, node_id, node_id)
        name, kind, qos = _interface_of(entity)
        return describe(
            _kind(entity),
            node_id,
            next(self._ids),
            name=name,
            type_name=kind.name,
            type_hash=kind.type_hash,
            qos=qos,
        )

    # What arrives, on the transport's threads

    def _on_entity(self, entity: Entity, appeared: bool) -> None:
        with self._domain.lock:
            changed = self.others.add(entity) if appeared else self.others.remove(entity.gid)
            joined = self.others.get(entity.gid)
        _notify(changed)
        if joined is not None and not isinstance(joined, GraphNode) and joined.encounters:
            encounters, joined.encounters = joined.encounters, ()
            self.attend_to(encounters)

    def _on_alive(self, gid: bytes) -> None:
        writer = self.others.get(gid)
        if isinstance(writer, RemoteWriter):
            writer.note_life()

    def _on_sample(self, reader: Reader, data: bytes, number: int, stamp: int, gid: bytes) -> None:
        now = timing.time_ns()
        writer = self.others.get(gid)
        if isinstance(writer, RemoteWriter):
            # Another definition has a subscription of its own (`Adapted`).
            is_matched = writer.kind.type_hash == reader.kind.type_hash and writer.reaches(reader)
            if not is_matched or stamp <= now - writer.qos.lifespan:
                return  # not matched, or too old
            writer.note_life()
        # Otherwise nobody has announced this publisher: some tools send without.
        reader.accept((data, stamp, number, now))


class _Outlet:
    """A publication as a `rmw_local.writer.Outlet`."""

    def __init__(self, publication: Publication) -> None:
        self._put = publication.put
        self.assert_alive: Callable[[], None] = publication.assert_alive

    def accept(self, sample: Sample) -> None:
        self._put(sample[0], sample[2], sample[1])

    store = accept

    def announce(self) -> None:
        pass


def _ask(asking: Asking, letter: Letter) -> None:
    data, stamp, _, number, *_ = letter
    asking.ask(data, number, stamp)


def _reply(serving: Serving, letter: Letter) -> bool:
    data, stamp, client, number, *_ = letter
    return serving.reply(data, number, stamp, client)


def _on_reply(client: ServiceClient, data: bytes, number: int, stamp: int) -> None:
    client.accept((data, stamp, client.gid, number))


def _on_request(server: ServiceServer, data: bytes, number: int, stamp: int, gid: bytes) -> None:
    server.accept((data, stamp, gid, number))


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

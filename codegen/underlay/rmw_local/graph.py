"""The graph: participants (one for each context), nodes, and the endpoints that they make in a domain."""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import os
from collections.abc import Iterable
from functools import cache, cached_property
from typing import TYPE_CHECKING, ClassVar, Final, TypeAlias

from rmw_local import observer, timing
from rmw_local.domain import Domain, endpoints
from rmw_local.qos import INFINITE, TRANSIENT_LOCAL, resolve_offered, resolve_requested
from rmw_local.reader import LifespanReader, Reader, UnboundedLifespanReader, UnboundedReader
from rmw_local.service import ServiceClient, ServiceEndpoint, ServiceQos, ServiceServer
from rmw_local.writer import DurableWriter, Writer

if TYPE_CHECKING:
    from ifgen_runtime.mismatch.reporting import WarningLimit

    from rmw_local.content_filter import ContentFilter
    from rmw_local.lockstep.side import Side
    from rmw_local.message import MessageType, ServiceType
    from rmw_local.qos import QosProfile
    from rmw_local.ready import ReadySource

Entity: TypeAlias = "GraphNode | Writer | Reader | ServiceEndpoint"


# By whether messages grow too old, and whether all are kept.
_READERS: Final[dict[tuple[bool, bool], type[Reader]]] = {
    (False, False): Reader,
    (False, True): UnboundedReader,
    (True, False): LifespanReader,
    (True, True): UnboundedLifespanReader,
}


# For glibc's allocator: where it gives large blocks back at once, an image of 1 MB pays for 450 page faults,
# 0.9 ms instead of 0.04 ms.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_KEPT: Final = 64 << 20  # bytes of free memory kept at the end of the heap
_LARGEST: Final = 32 << 20  # bytes; glibc allows no more
_MALLOC_SETTINGS: Final = ("MALLOC_TRIM_THRESHOLD_", "MALLOC_MMAP_THRESHOLD_", "GLIBC_TUNABLES")


def range_is_off() -> bool:
    """Whether ROS_AUTOMATIC_DISCOVERY_RANGE says that nobody is to be found."""
    return os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") == "OFF"


class TypeConflictError(Exception):
    """A topic name is already in use with another type in the same participant."""

    def __init__(self, topic: str, type_name: str) -> None:
        super().__init__(f"existing topic name {topic} with incompatible type {type_name}")
        self.topic = topic
        self.type_name = type_name


class Participant:
    """One context's presence in a domain."""

    _prefixes = itertools.count(1)
    side: Side | None = None  # this process's side of a lockstep run
    writers: tuple[type[Writer], type[Writer]] = Writer, DurableWriter

    def __init__(self, domain_id: int) -> None:
        _keep_freed_memory()
        self.domain = Domain.numbered(domain_id)
        self._is_alone = range_is_off()
        self.keeps_to_itself = self._is_alone or not isinstance(timing.driver, timing.SystemDriver)
        """Whether nobody outside this process is to see it. A virtual clock is nobody else's."""
        if timing.driver.side is not None:
            from rmw_local.lockstep.held import HeldDurableWriter, HeldWriter  # late: few programs need it

            self.side, self.writers = timing.driver.side, (HeldWriter, HeldDurableWriter)
            self.keeps_to_itself = False
        self.has_ended = False  # whether its context was shut down; then nothing is said any more
        # 16-byte gids as DDS makes them: vendor, process, participant, entity
        process = os.getpid() & 0xFFFFFFFF
        self._prefix = b"\x01\x0f" + process.to_bytes(4, "big") + next(self._prefixes).to_bytes(6, "big")
        self._entities = itertools.count(1)
        self._types: dict[str, tuple[str, int]] = {}

    @cached_property
    def warning_limit(self) -> WarningLimit:
        """The number of warnings about definitions that differ."""
        from ifgen_runtime.mismatch.reporting import WarningLimit  # late: definitions hardly ever differ

        return WarningLimit()

    def next_gid(self) -> bytes:
        """Return a new 16-byte gid."""
        return self._prefix + next(self._entities).to_bytes(4, "big")

    def leave(self) -> None:
        """Take all nodes and endpoints out of the graph that are still there."""
        self.domain.close_pending()
        with self.domain.lock:
            nodes = [node for node in self.domain.nodes if node.participant is self]
            mine = [each for each in endpoints(self.domain) if each.node.participant is self]
        for endpoint in mine:
            if isinstance(endpoint, Writer):
                endpoint.node.close_writer(endpoint)
            elif isinstance(endpoint, Reader):
                endpoint.node.close_reader(endpoint)
            else:
                endpoint.node.close_service_endpoint(endpoint)
        for node in nodes:
            node.close()

    def create_node(self, name: str, namespace: str, enclave: str = "/") -> GraphNode:
        """Announce a node; several may have one name."""
        node = GraphNode(self, name, namespace, enclave)
        if self.side is not None:
            self.side.join(self.domain)
        elif not self.keeps_to_itself:
            self.domain.reach_out()
        elif not self._is_alone:
            self.domain.stay_apart()
        with self.domain.lock:
            self.domain.nodes[node] = None
        node.announce(node, [])
        return node

    def claim(self, topic: str, type_name: str) -> None:
        """Use a topic with a type: within a participant, a name has one type at a time. Lock held."""
        known, users = self._types.get(topic, (type_name, 0))
        if known != type_name:
            raise TypeConflictError(topic, type_name)
        self._types[topic] = (type_name, users + 1)

    def release(self, topic: str) -> None:
        """Use it no longer. Lock held."""
        known, users = self._types[topic]
        if users > 1:
            self._types[topic] = (known, users - 1)
        else:
            del self._types[topic]


class GraphNode:
    """A node as others see it; it makes the endpoints."""

    is_remote: ClassVar[bool] = False
    """Whether it stands for a node in another process."""

    def __init__(self, participant: Participant, name: str, namespace: str, enclave: str) -> None:
        self.participant = participant
        self.name = name
        self.namespace = namespace
        self.enclave = enclave
        self.closed = False
        self.on_type_mismatch = "warn"  # what to do if another endpoint has another definition of a type

    @property
    def full_name(self) -> str:
        """The fully qualified name."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    def create_writer(self, message_type: MessageType, topic: str, qos: QosProfile) -> Writer:
        """Join a topic as publisher; raises TypeConflictError."""
        domain = self.participant.domain
        domain.close_pending()
        with domain.lock:
            self.participant.claim(topic, message_type.name)
            place = domain.topic(topic)
            resolved = resolve_offered(qos, [reader.qos for reader in place.readers])
            make = self.participant.writers[resolved.durability == TRANSIENT_LOCAL]
            writer = make(self, message_type, topic, resolved)
            changed = place.add_writer(writer)
        self.announce(writer, changed)
        self._report_encounters(writer)
        return writer

    def create_reader(
        self,
        message_type: MessageType,
        topic: str,
        qos: QosProfile,
        content_filter: ContentFilter | None = None,
    ) -> Reader:
        """Join a topic as subscriber; raises TypeConflictError."""
        domain = self.participant.domain
        domain.close_pending()
        with domain.lock:
            self.participant.claim(topic, message_type.name)
            place = domain.topic(topic)
            resolved = resolve_requested(qos, [writer.qos for writer in place.writers])
            make = _READERS[resolved.lifespan < INFINITE, resolved.queue_length is None]
            reader = make(self, message_type, topic, resolved)
            if content_filter is not None:  # it has to be there before durable writers replay
                reader.takes_parcels = False
                reader.set_filter(content_filter)
            changed = place.add_reader(reader)
        self.announce(reader, changed)
        self._report_encounters(reader)
        return reader

    def create_client(self, service_type: ServiceType, name: str, qos: QosProfile) -> ServiceClient:
        """Join a service as client; raises TypeConflictError."""
        client = ServiceClient(self, service_type, name, _service_qos(qos))
        self._join_service(client)
        return client

    def create_server(self, service_type: ServiceType, name: str, qos: QosProfile) -> ServiceServer:
        """Join a service as server; raises TypeConflictError."""
        server = ServiceServer(self, service_type, name, _service_qos(qos))
        self._join_service(server)
        return server

    def close_writer(self, writer: Writer) -> None:
        """Leave the topic; quiet when it has left already."""
        domain = self.participant.domain
        with domain.lock:
            if writer.closed:
                return
            writer.closed = True
            changed = domain.topics[writer.topic].remove_writer(writer)
            self._leave_topic(writer.topic)
        self._renounce(writer, changed)

    def close_reader(self, reader: Reader) -> None:
        """Leave the topic; quiet when it has left already."""
        domain = self.participant.domain
        with domain.lock:
            if reader.closed:
                return
            reader.closed = True
            changed = domain.topics[reader.topic].remove_reader(reader)
            self._leave_topic(reader.topic)
        _record_unread(reader.topic, reader.unread)
        self._renounce(reader, changed)

    def close_service_endpoint(self, endpoint: ServiceEndpoint) -> None:
        """Leave the service; quiet when it has left already."""
        domain = self.participant.domain
        with domain.lock:
            if endpoint.closed:
                return
            endpoint.closed = True
            service = domain.services[endpoint.name]
            changed = service.remove(endpoint)
            if service.is_empty():
                del domain.services[endpoint.name]
            self.participant.release(request_topic(endpoint.name))
        _record_unread(endpoint.name, endpoint.unread)
        self._renounce(endpoint, changed)

    def close(self) -> None:
        """Leave the graph; endpoints are closed on their own."""
        with self.participant.domain.lock:
            if self.closed:
                return
            self.closed = True
            del self.participant.domain.nodes[self]
        self._renounce(self, [])

    def _join_service(self, endpoint: ServiceEndpoint) -> None:
        domain = self.participant.domain
        domain.close_pending()
        with domain.lock:
            self.participant.claim(request_topic(endpoint.name), endpoint.service_type.name)
            domain.service(endpoint.name).add(endpoint)
        self.announce(endpoint, [])
        self._report_encounters(endpoint)

    def _leave_topic(self, name: str) -> None:
        topics = self.participant.domain.topics
        self.participant.release(name)
        if topics[name].is_empty():
            del topics[name]

    def announce(self, entity: Entity, changed: Iterable[ReadySource]) -> None:
        """Tell everybody that an entity of this node has joined, with no lock held."""
        _record_opened(entity)
        self._notify(changed)
        link = self.participant.domain.link
        if link is not None:
            link.announce(entity)

    def _report_encounters(self, newcomer: Writer | Reader | ServiceEndpoint) -> None:
        if not newcomer.encounters:
            return
        from rmw_local.mismatch.reporting import report  # late: definitions hardly ever differ

        encounters, newcomer.encounters = newcomer.encounters, ()
        report(each for each in encounters if not each.crosses_processes)
        remote = [each for each in encounters if each.crosses_processes]
        link = self.participant.domain.link
        if remote and link is not None:
            link.attend_to(remote)

    def _renounce(self, entity: Entity, changed: Iterable[ReadySource]) -> None:
        link = self.participant.domain.link
        if link is not None:
            link.withdraw(entity)
        watching = observer.current()
        if watching is not None:
            watching.closed(entity)
        self._notify(changed)

    def _notify(self, changed: Iterable[ReadySource]) -> None:
        for source in changed:
            source.notify()
        self.participant.domain.changed.notify()


def request_topic(service: str) -> str:
    """Return the name under which a service's requests travel, which no topic can have."""
    return f"rq{service}Request"


def _service_qos(qos: QosProfile) -> ServiceQos:
    return ServiceQos(writer=resolve_offered(qos, ()), reader=resolve_requested(qos, ()))


def _record_opened(entity: object) -> None:
    watching = observer.current()
    if watching is not None:
        watching.opened(entity)


def _record_unread(name: str, unread: int) -> None:
    watching = observer.current()
    if watching is not None and unread:
        watching.undelivered(name, unread, "never read")


@cache
def _keep_freed_memory() -> None:
    """Let glibc keep freed memory for the next large message, unless the user has set it otherwise."""
    if os.name != "posix" or any(name in os.environ for name in _MALLOC_SETTINGS):
        return
    with contextlib.suppress(AttributeError, OSError):  # no glibc
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(_M_TRIM_THRESHOLD, _KEPT)
        mallopt(_M_MMAP_THRESHOLD, _LARGEST)

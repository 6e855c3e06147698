"""Nodes and endpoints of other processes, as the graph and the endpoints of this one see them.

They are matched like any others. What they would send or receive goes through a `Link`.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any, ClassVar, Final
from weakref import WeakValueDictionary

from rmw_local import timing
from rmw_local.graph import GraphNode, Participant
from rmw_local.message import Elsewhere, MessageType, ServiceType
from rmw_local.mismatch.passage import Marking
from rmw_local.notices import Drops, say
from rmw_local.reader import Reader
from rmw_local.service import ServiceClient, ServiceQos, ServiceServer
from rmw_local.transports.interface import Entity, Kind, Receipt
from rmw_local.writer import Writer

if TYPE_CHECKING:
    from rmw_local.domain import Domain
    from rmw_local.mismatch.encounter import Encounter
    from rmw_local.ready import ReadySource


class Arrivals:
    """The numbers of messages, which a publisher counts one by one."""

    __slots__ = ("last", "newest_lost")

    def __init__(self, first: int) -> None:
        """Begin with the first message that came: nobody misses those before it."""
        self.last = first
        self.newest_lost = 0

    def note(self, number: int) -> int:
        """Note a message; returns how many have been lost since the one before it.

        One that comes twice, or late, tells of no loss.
        """
        lost = number - self.last - 1
        if lost > 0:
            self.newest_lost = number - 1
        if lost >= 0:
            self.last = number
        return max(lost, 0)


class RemoteParticipant(Participant):
    """All other processes in a domain."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain

    def next_gid(self) -> bytes:
        """Return nothing: a gid is part of what others announce."""
        return b""


class RemoteNode(GraphNode):
    """A node of another process."""

    is_remote: ClassVar[bool] = True

    def __init__(self, participant: RemoteParticipant, entity: Entity) -> None:
        super().__init__(participant, entity.node, entity.namespace, entity.enclave)


class RemoteType(MessageType):
    """A message type of which only the name and the hash are known."""

    def __init__(self, name: str, type_hash: str) -> None:
        self.cls = Elsewhere
        self.name = name
        self.type_hash = type_hash
        self.drops = Drops(name)
        self.action = None
        self.serialize = self.deserialize = self.pack = _not_here


class RemoteServiceType(ServiceType):
    """A service type of which only the name and the hash are known."""

    def __init__(self, name: str, type_hash: str) -> None:
        self.cls = Elsewhere
        self.name = name
        self.type_hash = type_hash
        self.action = None
        self.request, self.response = RemoteType(f"{name}_Request", ""), RemoteType(f"{name}_Response", "")


class RemoteWriter(Writer):
    """A publisher in another process."""

    is_remote = True

    def __init__(self, node: RemoteNode, entity: Entity) -> None:
        kind = RemoteType(entity.type_name, entity.type_hash)
        super().__init__(node, kind, entity.name, entity.qos)
        self.gid = entity.gid
        self._arrivals: dict[Reader, Arrivals] = {}

    def note_arrival(self, reader: Reader, number: int) -> None:
        """Note that a message has come to a matched reader, and count those that must have been lost."""
        arrivals = self._arrivals.get(reader)
        if arrivals is None:
            self._arrivals[reader] = Arrivals(number)
        elif lost := arrivals.note(number):
            reader.message_lost.add(lost)
            reader.message_lost.notify()

    def receipt(self, reader: Reader, gid: bytes) -> Receipt:
        """Return what a matched reader has got, which its process has announced with this gid."""
        arrivals = self._arrivals.get(reader)
        return Receipt(gid, 0, 0) if arrivals is None else Receipt(gid, arrivals.last, arrivals.newest_lost)

    def disconnect(self, reader: Reader) -> None:
        """Part from a reader: what comes when they meet again has no connection with what came before."""
        super().disconnect(reader)
        self._arrivals.pop(reader, None)

    def note_life(self) -> None:
        """Note that it has published, or said that it is alive."""
        if self._manual:
            self.sign_leases()


class RemoteReader(Reader):
    """A subscription in another process. Its writers have a sink that serves all of their like."""

    is_remote = True

    def __init__(self, node: RemoteNode, entity: Entity) -> None:
        kind = RemoteType(entity.type_name, entity.type_hash)
        super().__init__(node, kind, entity.name, entity.qos)
        self.peer = entity.peer
        self.gid = entity.gid
        self.stands_in = entity.stands_in


class RemoteClient(ServiceClient):
    """A service client in another process."""

    is_remote = True

    def __init__(self, node: RemoteNode, entity: Entity) -> None:
        super().__init__(node, _service_type(entity), entity.name, ServiceQos(entity.qos, entity.qos))
        self.gid = entity.gid
        self.refuses = entity.refuses


class RemoteServer(ServiceServer):
    """A service server in another process."""

    is_remote = True

    def __init__(self, node: RemoteNode, entity: Entity) -> None:
        super().__init__(node, _service_type(entity), entity.name, ServiceQos(entity.qos, entity.qos))
        self.peer = entity.peer
        self.gid = entity.gid
        self.stands_in = entity.stands_in
        self.refuses = entity.refuses


def _service_type(entity: Entity) -> RemoteServiceType:
    return RemoteServiceType(entity.type_name, entity.type_hash)


def _not_here(_: Any) -> Any:
    raise AssertionError("an endpoint of another process neither serialises nor deserialises here")


_MOST_ENTITIES: Final = 50_000
"""The number of nodes and endpoints of others that a domain's graph has.

It is one for all peers: a token says itself whose it is, so a limit for each would not stop a peer that lies.
"""
_MOST_WAITING: Final = 10_000
"""The number of those that wait for room in it, in the order in which they came."""

Remote = RemoteNode | RemoteWriter | RemoteReader | RemoteClient | RemoteServer


class Others:
    """Everybody whom a domain knows from outside.

    Every method but `get` is called with the domain's lock held. Methods return the sources to notify once
    the lock is released.
    """

    def __init__(self, domain: Domain) -> None:
        self.refused = 0
        """The number of entities that others announced when there was no room."""
        self._waiting: OrderedDict[bytes, Entity] = OrderedDict()  # of those, by gid
        self._domain = domain
        self._participant = RemoteParticipant(domain)
        self._known: dict[bytes, Remote] = {}  # by gid
        self._nodes: WeakValueDictionary[tuple[str, int], RemoteNode] = WeakValueDictionary()

    def __len__(self) -> int:
        return len(self._known)

    def get(self, gid: bytes) -> Remote | None:
        """Return the node or the endpoint with this gid."""
        return self._known.get(gid)

    def add(self, entity: Entity) -> list[ReadySource]:
        """Let an entity join the graph."""
        if entity.gid in self._known:
            return []
        if len(self._known) >= _MOST_ENTITIES:
            self._refuse(entity)
            return []
        node = self._node_of(entity)
        joined: Remote
        changed: list[ReadySource] = []
        match entity.kind:
            case Kind.NODE:
                joined = node
                self._domain.nodes[node] = None
            case Kind.PUBLISHER:
                joined = RemoteWriter(node, entity)
                changed = self._domain.topic(entity.name).add_writer(joined)
            case Kind.SUBSCRIPTION:
                joined = RemoteReader(node, entity)
                changed = self._domain.topic(entity.name).add_reader(joined)
            case Kind.CLIENT:
                joined = RemoteClient(node, entity)
                self._domain.service(entity.name).add(joined)
            case Kind.SERVER:
                joined = RemoteServer(node, entity)
                self._domain.service(entity.name).add(joined)
        self._known[entity.gid] = joined
        return [*changed, self._domain.changed]

    def take_next(self) -> Entity | None:
        """Remove and return the first entity that waits, if there is room for it."""
        if not self._waiting or len(self._known) >= _MOST_ENTITIES:
            return None
        return self._waiting.popitem(last=False)[1]

    def remove(self, gid: bytes) -> list[ReadySource]:
        """Let an entity leave the graph, or wait for it no longer."""
        self._waiting.pop(gid, None)
        left = self._known.pop(gid, None)
        if left is None:
            return []
        left.closed = True
        changed: list[ReadySource] = []
        topics, services = self._domain.topics, self._domain.services
        if isinstance(left, RemoteNode):
            del self._domain.nodes[left]
        elif isinstance(left, RemoteWriter | RemoteReader):
            topic = topics[left.topic]
            changed = (
                topic.remove_writer(left) if isinstance(left, RemoteWriter) else topic.remove_reader(left)
            )
            if topic.is_empty():
                del topics[left.topic]
        else:
            service = services[left.name]
            changed = service.remove(left)
            if service.is_empty():
                del services[left.name]
        return [*changed, self._domain.changed]

    def remove_all(self) -> list[ReadySource]:
        """Let everybody leave."""
        self._waiting.clear()
        return [source for gid in list(self._known) for source in self.remove(gid)]

    def _node_of(self, entity: Entity) -> RemoteNode:
        key = (entity.peer, entity.node_id)
        node = self._nodes.get(key)
        if node is None:  # endpoints may come before their node
            node = self._nodes[key] = RemoteNode(self._participant, entity)
        return node

    def _refuse(self, entity: Entity) -> None:
        if len(self._waiting) < _MOST_WAITING:
            self._waiting[entity.gid] = entity
        if not self.refused:
            say(
                f"other processes announce more than {_MOST_ENTITIES} nodes and endpoints in ROS domain "
                f"{self._domain.number}: the rest is ignored until there is room"
            )
        self.refused += 1


class Adapted:
    """Delivers what is addressed to one other definition. It is an `OnSample`."""

    def __init__(self, others: Others, encounter: Encounter) -> None:
        """`encounter` is the first one with a publisher of that definition."""
        assert isinstance(encounter.mine, Reader) and encounter.origin is not None
        self.reader = encounter.mine
        self.type_hash = encounter.theirs.kind.type_hash
        self._others = others
        # Messages may be faster than what announces their publisher. They count as those of the first one.
        self._unknown = Marking(self.reader, encounter.origin)

    def __call__(self, data: bytes, number: int, stamp: int, gid: bytes) -> None:
        """Deliver a message."""
        now = timing.time_ns()
        end = self._unknown
        writer = self._others.get(gid)
        if isinstance(writer, RemoteWriter):
            marked = writer.receiver(self.reader)
            is_theirs = writer.kind.type_hash == self.type_hash and writer.reaches(self.reader)
            if not (is_theirs and isinstance(marked, Marking)):
                return  # not matched
            writer.note_arrival(self.reader, number)
            if stamp <= now - writer.qos.lifespan:
                return  # too old
            writer.note_life()
            end = marked
        end.accept((data, stamp, number, now, gid))

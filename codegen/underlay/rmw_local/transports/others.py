"""The nodes and endpoints of other processes that have joined a domain's graph."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Final
from weakref import WeakValueDictionary

from rmw_local.notices import say
from rmw_local.transports.remote import (
    RemoteClient,
    RemoteNode,
    RemoteParticipant,
    RemoteReader,
    RemoteServer,
    RemoteWriter,
)
from rmw_local.transports.seam import Entity, Kind

if TYPE_CHECKING:
    from rmw_local.domain import Domain
    from rmw_local.ready import ReadySource

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

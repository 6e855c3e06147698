"""The nodes and endpoints of other processes that have joined a domain's graph."""

from __future__ import annotations

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
    from rmw_local.graph import Domain
    from rmw_local.ready import ReadySource

_MOST_ENTITIES: Final = 50_000
"""The number of nodes and endpoints of others that a domain remembers."""

Remote = RemoteNode | RemoteWriter | RemoteReader | RemoteClient | RemoteServer


class Others:
    """Everybody whom a domain knows from outside.

    Every method but `get` is called with the domain's lock held. Methods return the sources to notify once
    the lock is released.
    """

    def __init__(self, domain: Domain) -> None:
        self.refused = 0
        """The number of entities that others announced in excess of what is remembered."""
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
            self._refuse()
            return []
        node = self._node_of(entity)
        joined: Remote
        changed: list[ReadySource] = []
        match entity.kind:
            case Kind.NODE:
                joined = node
                self._domain.nodes.append(node)
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

    def remove(self, gid: bytes) -> list[ReadySource]:
        """Let an entity leave the graph."""
        left = self._known.pop(gid, None)
        if left is None:
            return []
        left.closed = True
        changed: list[ReadySource] = []
        topics, services = self._domain.topics, self._domain.services
        if isinstance(left, RemoteNode):
            self._domain.nodes.remove(left)
        elif isinstance(left, RemoteWriter | RemoteReader):
            topic = topics[left.topic]
            changed = (
                topic.remove_writer(left) if isinstance(left, RemoteWriter) else topic.remove_reader(left)
            )
            if topic.is_empty():
                del topics[left.topic]
        else:
            service = services[left.name]
            service.remove(left)
            if service.is_empty():
                del services[left.name]
        return [*changed, self._domain.changed]

    def remove_all(self) -> list[ReadySource]:
        """Let everybody leave."""
        return [source for gid in list(self._known) for source in self.remove(gid)]

    def _node_of(self, entity: Entity) -> RemoteNode:
        key = (entity.peer, entity.node_id)
        node = self._nodes.get(key)
        if node is None:  # endpoints may come before their node
            node = self._nodes[key] = RemoteNode(self._participant, entity)
        return node

    def _refuse(self) -> None:
        if not self.refused:
            say(
                f"other processes announce more than {_MOST_ENTITIES} nodes and endpoints in ROS domain "
                f"{self._domain.number}: the rest is ignored"
            )
        self.refused += 1

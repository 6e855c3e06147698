"""Nodes and endpoints of other processes, as the graph and the endpoints of this one see them.

They are matched like any others. What they would send or receive goes through a `Link`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from rmw_local.graph import GraphNode, Participant
from rmw_local.message import Elsewhere, MessageType, ServiceType
from rmw_local.notices import Drops
from rmw_local.reader import Reader
from rmw_local.service import ServiceClient, ServiceQos, ServiceServer
from rmw_local.transports.arrivals import Arrivals
from rmw_local.transports.seam import Receipt
from rmw_local.writer import Writer

if TYPE_CHECKING:
    from rmw_local.domain import Domain
    from rmw_local.transports.seam import Entity


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
    """A subscription in another process. Its writers have an outlet that serves all of their like."""

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

"""Services: clients and servers of one name, their queues, and their matching.

Underneath, a service is two topics; a request reaches every matched server, a response its client.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from rmw_local import observer, timing
from rmw_local.message import DecodeError, SerializationError, as_raised
from rmw_local.qos import mismatch
from rmw_local.ready import ReadySource

if TYPE_CHECKING:
    from rmw_local.encounter import Encounter
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType, ServiceType
    from rmw_local.origin import Origin
    from rmw_local.qos import QosProfile

# A request or a response on its way: (CDR bytes, source stamp [ns, system time], the client's gid,
# the request's number at its client). If the bytes may be of another definition, an Origin is the fifth.
Letter = tuple[bytes, int, bytes, int] | tuple[bytes, int, bytes, int, "Origin"]
_UNMARKED = 4


@dataclass(frozen=True, slots=True)
class ServiceQos:
    """The resolved profiles of the two topics beneath one client or server."""

    writer: QosProfile
    reader: QosProfile


class ServiceEndpoint(ReadySource):
    """A client or a server with the queue of what it has yet to take."""

    role: ClassVar[str]
    is_remote: ClassVar[bool] = False
    """Whether it stands for one in another process."""
    encounters: tuple[Encounter, ...] = ()  # with other definitions, until they are told of
    sends: MessageType
    takes: MessageType

    def __init__(self, node: GraphNode, service_type: ServiceType, name: str, qos: ServiceQos) -> None:
        super().__init__()
        self.node = node
        self.service_type = service_type
        self.name = name
        self.qos = qos
        self.gid = node.participant.next_gid()
        self.closed = False
        self._observer = observer.current()
        self._queue: deque[Letter] = deque(maxlen=qos.reader.queue_length)

    @property
    def kind(self) -> ServiceType:
        """Its type, as services and topics both have one."""
        return self.service_type

    @property
    def end(self) -> ServiceEndpoint:
        """Itself: what stands for one has it there."""
        return self

    def is_ready(self) -> bool:
        """Whether something waits."""
        return bool(self._queue)

    def accept(self, letter: Letter) -> None:
        """Queue it and notify the listeners."""
        if self._observer is not None and len(self._queue) == self._queue.maxlen:
            self._observer.undelivered(self.name, 1, "overwritten before it was read")
        self._queue.append(letter)
        for listener in self._listeners:
            listener()

    def take(self) -> Letter | None:
        """Remove and return the oldest, None if there is none."""
        try:
            return self._queue.popleft()
        except IndexError:
            return None

    def read(self, letter: Letter) -> Any:
        """The message in what was taken; None if it is malformed, which was counted."""
        kind = self.takes
        try:
            if len(letter) == _UNMARKED:
                return kind.deserialize(letter[0])
            origin: Any = letter[-1]
            return origin.read(letter[0], kind, kind.deserialize, self.node)
        except DecodeError:
            kind.drops.add()
            return None

    @property
    def unread(self) -> int:
        """The number of waiting requests or responses."""
        return len(self._queue)


class ServiceClient(ServiceEndpoint):
    """The asking end."""

    role = "service client"

    def __init__(self, node: GraphNode, service_type: ServiceType, name: str, qos: ServiceQos) -> None:
        super().__init__(node, service_type, name, qos)
        self.sends, self.takes = service_type.request, service_type.response
        self.servers: tuple[Any, ...] = ()  # servers, or what stands for them (`rmw_local.passage`)
        self.beyond: Callable[[Letter], object] | None = None  # takes requests to other processes
        self._numbers = itertools.count(1)

    def send(self, request: Any) -> int:
        """Send a request to every matched server; return its number, from 1."""
        data = _serialized(self.sends, request)
        number = next(self._numbers)
        letter = (data, timing.time_ns(), self.gid, number)
        servers = self.servers
        far = False
        for server in servers:
            if server.is_remote:
                far = True
            else:
                server.accept(letter)
        if far and self.beyond is not None:
            self.beyond(letter)  # once, for all of them
        if self._observer is not None and not servers:
            self._observer.undelivered(self.name, 1, "requested while no service was matched")
        return number


class ServiceServer(ServiceEndpoint):
    """The answering end."""

    role = "service server"

    def __init__(self, node: GraphNode, service_type: ServiceType, name: str, qos: ServiceQos) -> None:
        super().__init__(node, service_type, name, qos)
        self.sends, self.takes = service_type.response, service_type.request
        self.clients: dict[bytes, Any] = {}  # clients, or what stands for them; replaced, never changed
        # Takes responses to other processes; False if the client is not there either.
        self.beyond: Callable[[Letter], bool] | None = None

    def respond(self, client_gid: bytes, number: int, response: Any) -> None:
        """Send a response. If the client is gone, it is dropped."""
        data = _serialized(self.sends, response)
        client = self.clients.get(client_gid)
        letter = (data, timing.time_ns(), client_gid, number)
        if client is not None and not client.is_remote:
            client.accept(letter)
        elif self.beyond is not None and self.beyond(letter):
            return
        elif self._observer is not None:
            self._observer.undelivered(self.name, 1, "answered when the client was gone")


class ServiceName:
    """All clients and servers of one service name in one domain. Called with the domain's lock held."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.clients: list[ServiceClient] = []
        self.servers: list[ServiceServer] = []

    def add(self, endpoint: ServiceEndpoint) -> None:
        """Let a client or a server join."""
        if isinstance(endpoint, ServiceClient):
            self.clients.append(endpoint)
            for server in self.servers:
                _introduce(endpoint, server, endpoint)
        elif isinstance(endpoint, ServiceServer):
            self.servers.append(endpoint)
            for client in self.clients:
                _introduce(client, endpoint, endpoint)

    def remove(self, endpoint: ServiceEndpoint) -> None:
        """Let it leave."""
        if isinstance(endpoint, ServiceClient):
            self.clients.remove(endpoint)
            for each in endpoint.servers:
                server = each.end
                server.clients = {gid: known for gid, known in server.clients.items() if gid != endpoint.gid}
        elif isinstance(endpoint, ServiceServer):
            self.servers.remove(endpoint)
            for client in self.clients:
                client.servers = tuple(known for known in client.servers if known.end is not endpoint)

    def is_empty(self) -> bool:
        """True if no endpoint is left."""
        return not self.clients and not self.servers


def _serialized(kind: MessageType, message: Any) -> bytes:
    try:
        return kind.serialize(message)
    except SerializationError as error:
        raise as_raised(error) from None


def _introduce(client: ServiceClient, server: ServiceServer, newcomer: ServiceEndpoint) -> None:
    if client.is_remote and server.is_remote:
        return  # they meet where they are
    if client.service_type.name != server.service_type.name:
        return
    if mismatch(client.qos.writer, server.qos.reader) or mismatch(server.qos.writer, client.qos.reader):
        return
    to_client: Any = client
    to_server: Any = server
    if client.service_type.type_hash != server.service_type.type_hash:
        from rmw_local.encounter import meet_on_service  # late: definitions hardly ever differ

        encounter, ends = meet_on_service(client, server)
        newcomer.encounters = (*newcomer.encounters, encounter)
        if ends is None:
            return
        to_client, to_server = ends
    client.servers = (*client.servers, to_server)
    server.clients = {**server.clients, client.gid: to_client}

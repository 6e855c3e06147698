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
from rmw_local.message import DecodeError
from rmw_local.notices import no_response
from rmw_local.qos import mismatch
from rmw_local.ready import ReadySource
from rmw_local.topic import Ends

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType, ServiceType
    from rmw_local.mismatch.encounter import Encounter
    from rmw_local.mismatch.origin import Origin
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
    stands_in = False  # whether it is another one again, in another process, for a definition that it adapts
    refuses = False  # whether it is in another process, where other definitions are refused
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
        if len(self._queue) == self._queue.maxlen:
            self._overflow()
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

    def _overflow(self) -> None:
        """Make room for one more."""
        if self._observer is not None:
            self._observer.undelivered(self.name, 1, "overwritten before it was read")

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
        # By server, itself or what stands for it (`rmw_local.mismatch.passage`)
        self.servers: dict[ServiceServer, Any] = {}
        self._asked: dict[ServiceServer, Any] | None = {}  # a copy that nobody changes; None: to be made
        # Takes requests to those of the servers that are in other processes.
        self.beyond: Callable[[Letter, dict[ServiceServer, Any]], object] | None = None
        self._numbers = itertools.count(1)
        # By number: the servers that were asked, and of how many definitions of those elsewhere not all have
        # had their say.
        self._unanswered: dict[int, tuple[dict[ServiceServer, Any], int]] = {}
        self._failures: deque[tuple[int, str]] = deque()  # (number, reason), yet to be taken

    def is_ready(self) -> bool:
        """Whether a response or a failure waits."""
        return bool(self._queue or self._failures)

    def send(self, request: Any, *, expects_server: bool = False) -> int:
        """Send a request to every matched server; return its number, from 1.

        Without a server it is never answered. It fails if a server is expected, else it stays pending.
        """
        data = self.sends.serialize(request)
        number = next(self._numbers)
        letter = (data, timing.time_ns(), self.gid, number)
        servers = self._asked
        if servers is None:
            servers = self._copy_servers()
        if servers:
            definitions = {server.kind.type_hash for server in servers if server.is_remote}
            self._unanswered[number] = servers, len(definitions)
            for server, end in servers.items():
                if not server.is_remote:
                    end.accept(letter)
            if definitions and self.beyond is not None:
                self.beyond(letter, servers)  # once, for all of them
        elif expects_server:
            self._failures.append((number, no_response(self.name, ["the action server"], "")))
            self.notify()
        if self._observer is not None and not servers:
            self._observer.undelivered(self.name, 1, "requested while no service was matched")
        return number

    def connect(self, server: ServiceServer, end: Any) -> None:
        """Send to one more server, by way of `end`. The domain's lock is held, as for `disconnect`."""
        self.servers[server] = end
        self._asked = None

    def disconnect(self, server: ServiceServer) -> None:
        """Send to it no longer."""
        if self.servers.pop(server, None) is not None:
            self._asked = None

    def _copy_servers(self) -> dict[ServiceServer, Any]:
        with self.node.participant.domain.lock:
            self._asked = servers = dict(self.servers)
        return servers

    def accept(self, letter: Letter) -> None:
        """Queue a response."""
        self._unanswered.pop(letter[3], None)
        super().accept(letter)

    def take_failure(self) -> tuple[int, str] | None:
        """Remove and return the number of a request that nobody will answer, and the reason."""
        return self._failures.popleft() if self._failures else None

    def lose(self, server: ServiceServer) -> bool:
        """Expect nothing of a server that is closed; returns whether requests failed. Domain's lock held."""
        unanswered = list(self._unanswered.items())
        asked = [number for number, (servers, _) in unanswered if server in servers]
        failed = [number for number in asked if self._fail_if_all_are_gone(number)]
        return bool(failed)

    def give_up(self, number: int, reason: str) -> bool:
        """Expect nothing more of one definition from other processes; the rest as for `lose`.

        Without a reason, the request fails once the servers have left the graph, too. Who asks again at once
        would otherwise ask those that are going.
        """
        asked = self._unanswered.get(number)
        if asked is None:  # answered meanwhile
            return False
        servers, unfinished = asked
        self._unanswered[number] = servers, unfinished - 1
        return self._fail_if_all_are_gone(number, reason)

    def expect_less(self, number: int, server: ServiceServer, reason: str) -> bool:
        """Expect no answer of one server of this process; the rest as for `lose`."""
        asked = self._unanswered.get(number)
        if asked is None:
            return False
        servers, unfinished = asked
        others = {each: end for each, end in servers.items() if each is not server}
        if others:
            self._unanswered[number] = others, unfinished
            return self._fail_if_all_are_gone(number)
        del self._unanswered[number]
        self._failures.append((number, no_response(self.name, [server.node.full_name], reason)))
        return True

    def expect_nothing(self) -> None:
        """Forget all requests: their futures stay pending."""
        self._unanswered.clear()

    def expects(self, number: int) -> bool:
        """Whether somebody may yet answer a request."""
        return number in self._unanswered

    def _fail_if_all_are_gone(self, number: int, reason: str = "") -> bool:
        servers, unfinished = self._unanswered.get(number, ({}, 0))
        is_over = unfinished <= 0
        for each in servers:
            # One elsewhere may have answered before it left: the transport says when nothing more will come.
            is_gone = is_over and (each.closed or reason) if each.is_remote else each.closed
            if not is_gone:
                return False
        if self._unanswered.pop(number, None) is None:
            return False
        nodes = [each.node.full_name for each in servers]
        self._failures.append((number, no_response(self.name, nodes, reason)))
        return True


class ServiceServer(ServiceEndpoint):
    """The answering end."""

    role = "service server"

    def __init__(self, node: GraphNode, service_type: ServiceType, name: str, qos: ServiceQos) -> None:
        super().__init__(node, service_type, name, qos)
        self.sends, self.takes = service_type.response, service_type.request
        self.clients: dict[bytes, Any] = {}  # by gid: clients, or what stands for them
        # Takes responses to other processes; False if the client is not there either.
        self.beyond: Callable[[Letter], bool] | None = None
        # Says of requests from there that nobody will answer them.
        self.drop: Callable[[Letter], None] = _keep_quiet

    def read(self, letter: Letter) -> Any:
        """The request in what was taken; None if it is malformed, which was counted."""
        request = super().read(letter)
        if request is None:
            self.drop(letter)
        return request

    def _overflow(self) -> None:
        super()._overflow()
        oldest = self.take()
        if oldest is not None:  # else somebody has taken it meanwhile
            self.drop(oldest)

    def respond(self, client_gid: bytes, number: int, response: Any) -> None:
        """Send a response. If the client is gone, it is dropped."""
        data = self.sends.serialize(response)
        client = self.clients.get(client_gid)
        letter = (data, timing.time_ns(), client_gid, number)
        if client is not None and not client.is_remote:
            client.accept(letter)
        elif self.beyond is not None and self.beyond(letter):
            return
        elif self._observer is not None:
            self._observer.undelivered(self.name, 1, "answered when the client was gone")

    def fail(self, client_gid: bytes, number: int, reason: str) -> None:
        """Say that it does not answer a request."""
        with self.node.participant.domain.lock:
            client = self.clients.get(client_gid)
            if client is not None and client.end.is_remote:
                client = None
            has_failed = client is not None and client.end.expect_less(number, self, reason)
        if client is None:
            self.drop((b"", 0, client_gid, number))
        elif has_failed:
            client.end.notify()


class ServiceName:
    """All clients and servers of one service name in one domain. Called with the domain's lock held."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.clients: Ends[ServiceClient] = Ends()
        self.servers: Ends[ServiceServer] = Ends()

    def add(self, endpoint: ServiceEndpoint) -> None:
        """Let a client or a server join."""
        if isinstance(endpoint, ServiceClient):
            self.clients.add(endpoint)
            for server in self.servers.facing(endpoint):
                _introduce(endpoint, server, endpoint)
        elif isinstance(endpoint, ServiceServer):
            self.servers.add(endpoint)
            for client in self.clients.facing(endpoint):
                _introduce(client, endpoint, endpoint)

    def remove(self, endpoint: ServiceEndpoint) -> list[ReadySource]:
        """Let it leave; returns clients to be notified."""
        if isinstance(endpoint, ServiceClient):
            self.clients.remove(endpoint)
            for server in endpoint.servers:
                server.clients.pop(endpoint.gid, None)
            return []
        if isinstance(endpoint, ServiceServer):
            self.servers.remove(endpoint)
            clients = list(self.clients.facing(endpoint))
            for client in clients:
                client.disconnect(endpoint)
            return [client for client in clients if client.lose(endpoint)]
        return []

    def is_empty(self) -> bool:
        """True if no endpoint is left."""
        return not self.clients and not self.servers


def _keep_quiet(_: Letter) -> None:
    """Tell nobody: there are no other processes."""


def _introduce(client: ServiceClient, server: ServiceServer, newcomer: ServiceEndpoint) -> None:
    if client.service_type.name != server.service_type.name:
        return
    if mismatch(client.qos.writer, server.qos.reader) or mismatch(server.qos.writer, client.qos.reader):
        return
    to_client: Any = client
    to_server: Any = server
    are_equal = client.service_type.type_hash == server.service_type.type_hash
    if server.stands_in and (not are_equal or client.node.on_type_mismatch == "refuse"):
        return  # whom it stands for has met this client
    if not are_equal:
        from rmw_local.mismatch.encounter import meet_on_service  # late: definitions hardly ever differ

        encounter, ends = meet_on_service(client, server)
        newcomer.encounters = (*newcomer.encounters, encounter)
        if ends is None:
            return
        to_client, to_server = ends
    side = client.node.participant.side
    if side is not None and not (client.is_remote or server.is_remote):
        from rmw_local.lockstep.held import HeldEnd  # late: few programs need it

        to_client, to_server = HeldEnd(side, server, to_client), HeldEnd(side, client, to_server)
    client.connect(server, to_server)
    server.clients[client.gid] = to_client

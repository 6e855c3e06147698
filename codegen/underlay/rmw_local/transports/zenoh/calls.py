"""The short way of requests, between programs of one user on one machine: messages in place of queries.

A query, its answer and its end take Zenoh 70 us more than two messages. A process that takes requests this
way says so by a token. It gets them on a key of its own, `@ifgen_calls/<domain>/<to>/<from>`, with the ids of
the two sessions. The attachment is that of a service; the kind of the message and the server's gid follow.
Beyond this machine there are queries only: the access control of routers knows the keys of services.
"""

from __future__ import annotations

import struct
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import zenoh
from zenoh import CongestionControl, Locality, SampleKind

from rmw_local.notices import Repeated
from rmw_local.transports.zenoh import attachments, tokens

if TYPE_CHECKING:
    from rmw_local.transports.background import Background
    from rmw_local.transports.interface import OnOver, OnReply, OnRequest
    from rmw_local.transports.zenoh.presence import Gate
    from rmw_local.transports.zenoh.services import Serving

_KEY: Final = "@ifgen_calls"
_REST: Final = struct.Struct("<B16s")  # what it is, the server's gid
_REQUEST, _RESPONSE, _NO_RESPONSE = range(3)
_GRACE: Final = 0.5
"""Seconds that a response may take which was sent before its server went."""
_BETWEEN_LOOKS: Final = 0.01  # [s]

Server = tuple[str, bytes]
"""The id of a server's session, and its gid."""


class Calls:
    """The requests and responses of one session that go as messages."""

    def __init__(
        self, session: zenoh.Session, gate: Gate, background: Background, domain: int, malformed: Repeated
    ) -> None:
        self._session = session
        self._gate = gate
        self._background = background
        self._malformed = malformed
        self._prefix = f"{_KEY}/{domain}"
        self._id = str(session.zid())
        self._processes: set[str] = set()  # those that take requests this way: the ids of their sessions
        self._ways: dict[str, zenoh.Publisher] = {}  # to those that anything was sent to
        self._callers: dict[bytes, Caller] = {}  # by the client's gid
        self._servings: dict[bytes, tuple[Serving, OnRequest]] = {}  # by the server's gid
        self._declared: list[object] = []

    def begin(self) -> None:
        """Take requests this way, and say so, before anything else of this process is announced."""
        self._declared = [
            self._session.declare_subscriber(
                f"{self._prefix}/{self._id}/*",
                self._gate.callback(self._on_message),
                allowed_origin=Locality.REMOTE,
            ),
            self._session.liveliness().declare_token(f"{self._prefix}/{self._id}"),
            self._session.liveliness().declare_subscriber(
                f"{self._prefix}/*", self._gate.callback(self._on_process), history=True
            ),
        ]

    def end(self) -> None:
        """Say of all requests that wait here that nobody will answer them."""
        for serving, _ in tuple(self._servings.values()):
            serving.leave()

    def caller(self, gid: bytes, on_reply: OnReply, on_over: OnOver) -> Caller:
        """Let a client ask this way."""
        self._callers[gid] = caller = Caller(self, gid, on_reply, on_over)
        return caller

    def serve(self, gid: bytes, serving: Serving, on_request: OnRequest) -> Listed:
        """Let a server answer this way."""
        self._servings[gid] = serving, on_request
        return Listed(self._servings, gid)

    def forget(self, gid: bytes) -> None:
        """Let a client ask no longer."""
        self._callers.pop(gid, None)

    def reaches(self, servers: Sequence[Server]) -> bool:
        """Whether all of them are reached this way."""
        return bool(servers) and all(process in self._processes for process, _ in servers)

    def put(self, process: str, data: bytes, attachment: bytes) -> None:
        """Send a message to a process, if it is there; raises nothing."""
        if process in self._processes:
            self._gate.call(lambda: self._way(process).put(data, attachment=attachment))

    def _way(self, process: str) -> zenoh.Publisher:
        way = self._ways.get(process)
        if way is None:  # which takes 40 us less than to put by a key
            way = self._ways[process] = self._session.declare_publisher(
                f"{self._prefix}/{process}/{self._id}",
                congestion_control=CongestionControl.BLOCK,
                allowed_destination=Locality.REMOTE,
            )
        return way

    def lose(self, process: str) -> None:
        """End, soon, the requests that a process that is gone has not answered."""
        lost = [
            (caller, number, server)
            for caller in tuple(self._callers.values())
            for number, server in caller.expected_of(process)
        ]
        if lost:
            self._background.start(self._end_all, process, lost)

    def _end_all(self, process: str, lost: Sequence[tuple[Caller, int, Server]]) -> None:
        until = time.monotonic() + _GRACE
        while self._is_connected(process) and time.monotonic() < until:
            time.sleep(_BETWEEN_LOOKS)
        for caller, number, server in lost:
            caller.end(number, server)

    def _is_connected(self, process: str) -> bool:
        """Whether something may be on its way from a process."""
        found: list[str] = []
        self._gate.call(lambda: found.extend(map(str, self._session.info.peers_zid())))
        return process in found

    # Callbacks, on Zenoh's threads

    def _on_process(self, sample: zenoh.Sample) -> None:
        try:
            process = tokens.session_id(str(sample.key_expr).rpartition("/")[2])
        except ValueError as error:
            self._malformed.add(str(error))
            return
        if sample.kind == SampleKind.PUT and process != self._id:
            self._processes.add(process)
        elif process in self._processes:
            self._processes.discard(process)
            self._background.start(self._ways.pop, process, None)  # not here: it undeclares a publisher
            self.lose(process)

    def _on_message(self, sample: zenoh.Sample) -> None:
        process = str(sample.key_expr).rpartition("/")[2]
        attached = sample.attachment
        try:
            message = _read(b"" if attached is None else attached.to_bytes())
        except ValueError as error:
            self._malformed.add(str(error))
            return
        data = sample.payload.to_bytes()
        if message.what == _REQUEST:
            self._on_request(process, message, data)
        elif caller := self._callers.get(message.about.gid):
            answer = data if message.what == _RESPONSE else None
            caller.hear((process, message.server), message.about, answer)

    def _on_request(self, process: str, message: Message, data: bytes) -> None:
        number, stamp, client = message.about
        request = Called(self, process, message.server, client, number)
        found = self._servings.get(message.server)
        if found is None:  # gone meanwhile
            request.leave()
            return
        serving, on_request = found
        refused = serving.keep(request, client, number, len(data))
        if refused:
            self._malformed.add(refused)
            request.leave()
        else:
            on_request(data, number, stamp, client)


class Caller:
    """A client that asks this way."""

    def __init__(self, calls: Calls, gid: bytes, on_reply: OnReply, on_over: OnOver) -> None:
        self._calls = calls
        self._gid = gid
        self._on_reply = on_reply
        self._on_over = on_over
        self._expected: dict[int, set[Server]] = {}  # the servers that may yet answer, by request

    def ask(self, data: bytes, number: int, stamp: int, servers: Sequence[Server]) -> bool:
        """Send a request to these servers; False if one of them is not reached this way."""
        if not self._calls.reaches(servers):
            return False
        self._expected[number] = set(servers)
        for process, server in servers:
            attachment = attachments.pack(number, stamp, self._gid) + _REST.pack(_REQUEST, server)
            self._calls.put(process, data, attachment)
        for each in servers:
            if not self._calls.reaches([each]):  # gone meanwhile, perhaps before the request was noted
                self._calls.lose(each[0])
        return True

    def expected_of(self, process: str) -> list[tuple[int, Server]]:
        """The requests that servers of a process may yet answer, by number."""
        expected = tuple(self._expected.items())
        return [
            (number, server)
            for number, servers in expected
            for server in tuple(servers)
            if server[0] == process
        ]

    def hear(self, server: Server, about: attachments.Attachment, answer: bytes | None) -> None:
        """Take a server's answer to a request, or take note that there will be none."""
        if server in self._expected.get(about.number, ()):
            if answer is not None:
                self._on_reply(answer, about.number, about.stamp)
            self.end(about.number, server)

    def end(self, number: int, server: Server) -> None:
        """Expect nothing more of a server."""
        servers = self._expected.get(number)
        if servers is not None:
            servers.discard(server)
            if not servers and self._expected.pop(number, None) is not None:
                self._on_over(number, "")


class Called:
    """A request that has come this way."""

    __slots__ = ("_calls", "_client", "_number", "_process", "_server")

    def __init__(self, calls: Calls, process: str, server: bytes, client: bytes, number: int) -> None:
        self._calls = calls
        self._process = process
        self._server = server
        self._client = client
        self._number = number

    def answer(self, data: bytes, attachment: bytes) -> None:
        """Send a response."""
        self._calls.put(self._process, data, attachment + _REST.pack(_RESPONSE, self._server))

    def leave(self) -> None:
        """Say that there will be none."""
        attachment = attachments.pack(self._number, 0, self._client) + _REST.pack(_NO_RESPONSE, self._server)
        self._calls.put(self._process, b"", attachment)


class Listed:
    """A server that is there."""

    def __init__(self, servings: dict[bytes, tuple[Serving, OnRequest]], gid: bytes) -> None:
        self._servings, self._gid = servings, gid

    def undeclare(self) -> None:
        """Be there no longer."""
        self._servings.pop(self._gid, None)


class Message(NamedTuple):
    """The attachment of a message between two processes."""

    about: attachments.Attachment
    what: int
    server: bytes


def _read(data: bytes) -> Message:
    """Read an attachment; raises ValueError."""
    if len(data) <= _REST.size:
        raise ValueError(f"a request or a response has an attachment of {len(data)} bytes")
    what, server = _REST.unpack(data[-_REST.size :])
    if what > _NO_RESPONSE:
        raise ValueError(f"a message between two processes is of the kind {what}")
    return Message(attachments.unpack(data[: -_REST.size]), what, server)

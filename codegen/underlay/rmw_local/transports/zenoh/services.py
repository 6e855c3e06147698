"""The asking and the answering end of a service, over queries; see `calls` for the short way."""

from __future__ import annotations

import _thread
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, Final, Protocol

import zenoh
from ifgen_runtime.errors import printable
from zenoh import ConsolidationMode, Locality, QueryTarget

from rmw_local.transports.background import Background
from rmw_local.transports.interface import Ask, OnOver
from rmw_local.transports.zenoh import attachments
from rmw_local.transports.zenoh.calls import Caller, Calls, Listed, Server
from rmw_local.transports.zenoh.presence import Gate, Presence

TO_SERVERS: Final[dict[str, Any]] = {
    "target": QueryTarget.ALL_COMPLETE,
    "consolidation": ConsolidationMode.NONE,
    "allowed_destination": Locality.REMOTE,
}
"""The options of a query that goes to servers."""
_MOST_REQUESTS: Final = 10_000
"""The number of requests of one service that may wait for their responses."""
_MOST_BYTES: Final = 2**28
"""The size of those requests in all [bytes], unless it is a single one."""
_GRACE: Final = 0.5
"""Seconds that an answer may take which was sent before its server went."""
_LONGEST_REASON: Final = 100  # bytes
_RESULT_SERVICE: Final = "/_action/get_result"
_NO_END: Final = 100 * 365 * 86_400.0  # [s]


def patience(service: str) -> float | None:
    """The time [s] that a service has for its answers; None for the session's default."""
    return _NO_END if service.endswith(_RESULT_SERVICE) else None


class Questions:
    """The requests of a client to the servers of one definition: each is a query.

    They join `of_session`, those of all clients of the session.
    """

    def __init__(
        self,
        of_session: list[Questions],
        service: str,
        gate: Gate,
        background: Background,
        gid: bytes,
        get: Callable[..., object],
        on_reply: Callable[[zenoh.Reply], None],
        on_over: OnOver,
    ) -> None:
        self.service = service
        self.gid = gid
        self._gate = gate
        self._background = background
        self._get = get
        self._open: dict[int, bool] = {}  # the numbers of queries that are not over
        self.on_reply = on_reply
        self._on_over = on_over
        of_session.append(self)

    def ask(self, data: bytes, number: int, stamp: int) -> None:
        """Send a request."""
        attachment = attachments.pack(number, stamp, self.gid)
        self._open[number] = True
        query = _Query(self, number)
        handler = self._gate.callback_with_end(query, query.end)
        self._gate.call(partial(self._get, handler, payload=data, attachment=attachment))

    def end(self, number: int, reason: str = "") -> None:
        """Take a query for over, once."""
        if self._open.pop(number, False):
            self._on_over(number, reason)

    def lose_server(self) -> None:
        """End, soon, the queries that are on their way: Zenoh never ends one that meets a server's going."""
        if self._open:
            self._background.start(self._end_all, tuple(self._open), delay=_GRACE)

    def _end_all(self, numbers: tuple[int, ...]) -> None:
        for number in numbers:
            self.end(number)


class Asking(Presence):
    """A client."""

    def __init__(
        self,
        of_session: list[Questions],
        gate: Gate,
        token: zenoh.LivelinessToken,
        gid: bytes,
        ask: Ask,
        caller: Caller,
        calls: Calls,
    ) -> None:
        super().__init__(gate, token, gid)
        self._of_session = of_session
        self._ask = ask
        self._caller = caller
        self._calls = calls

    def ask(self, data: bytes, number: int, stamp: int, servers: Sequence[Server]) -> None:
        """Send a request: to these servers, or by a query to all, if the short way does not reach each."""
        if not self._caller.ask(data, number, stamp, servers):
            self._ask(data, number, stamp)

    def close(self) -> None:
        """Withdraw it, and forget what it has asked."""
        super().close()
        self._calls.forget(self.gid)
        for questions in tuple(self._of_session):
            if questions.gid == self.gid:
                with suppress(ValueError):  # another thread was faster
                    self._of_session.remove(questions)


class _Query:
    """A request that was sent."""

    __slots__ = ("__weakref__", "_number", "_questions", "_reason")

    def __init__(self, questions: Questions, number: int) -> None:
        self._questions = questions
        self._number = number
        self._reason = ""

    def __call__(self, reply: zenoh.Reply) -> None:
        error = reply.err
        if error is None:
            self._questions.on_reply(reply)
        else:
            said = error.payload.to_bytes()[:_LONGEST_REASON].decode(errors="replace")
            self._reason = printable(f"Zenoh says: {said}")  # or whoever has answered

    def end(self) -> None:
        self._questions.end(self._number, self._reason)


class Request(Protocol):
    """A request that has come."""

    def answer(self, data: bytes, attachment: bytes) -> None:
        """Send a response."""
        ...

    def leave(self) -> None:
        """Leave it without a response."""
        ...


class Queried:
    """A request that has come as a query."""

    __slots__ = ("_gate", "_key", "_query")

    def __init__(self, gate: Gate, key: str, query: zenoh.Query) -> None:
        self._gate = gate
        self._key = key
        self._query = query

    def answer(self, data: bytes, attachment: bytes) -> None:
        """Send a response."""
        self._gate.call(partial(self._query.reply, self._key, data, attachment=attachment))

    def leave(self) -> None:
        """Leave it without a response: it ends with the object."""


class Serving:
    """A server: a queryable with the requests that wait for their responses."""

    gid = b""

    def __init__(self, gate: Gate) -> None:
        self._gate = gate
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._requests: dict[tuple[bytes, int], tuple[Request, int]] = {}  # with their sizes [bytes]
        self._size = 0
        self._is_closed = False
        self._presence: Presence | None = None

    def follow(self, token: zenoh.LivelinessToken, gid: bytes, queryable: Any, listed: Listed) -> None:
        """Become present by this token."""
        self.gid = gid
        self._presence = Presence(self._gate, token, gid, queryable, listed)

    def keep(self, request: Request, client: bytes, number: int, size: int) -> str:
        """Keep a request of this size [bytes] until it is answered; returns why not, if it is refused."""
        with self._lock:
            if (client, number) in self._requests:
                return "a request came twice"
            is_full = len(self._requests) >= _MOST_REQUESTS or self._size + size > _MOST_BYTES
            if is_full and self._requests:
                return "too many requests wait for their responses"
            is_closed = self._is_closed
            if not is_closed:
                self._requests[client, number] = request, size
                self._size += size
        if is_closed:  # nobody would answer it
            request.leave()
        return ""

    def reply(self, data: bytes, number: int, stamp: int, client: bytes) -> bool:
        """Answer a request."""
        request = self._taken(client, number)
        if request is None:
            return False
        request.answer(data, attachments.pack(number, stamp, client))
        return True

    def drop(self, number: int, client: bytes) -> None:
        """Leave a request without a response."""
        request = self._taken(client, number)
        if request is not None:
            request.leave()

    def _taken(self, client: bytes, number: int) -> Request | None:
        with self._lock:
            request, size = self._requests.pop((client, number), (None, 0))
            self._size -= size
        return request

    def leave(self) -> None:
        """Leave all that is unanswered without a response, and what comes from now on."""
        with self._lock:
            self._is_closed = True
            left = [request for request, _ in self._requests.values()]
            self._requests.clear()
        for request in left:
            request.leave()

    def close(self) -> None:
        """Withdraw it, and give up what is unanswered."""
        if self._presence is not None:
            self._presence.close()
        self.leave()

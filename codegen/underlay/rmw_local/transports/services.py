"""Clients and servers of this process, shown to others: in their own definition, and in those they adapt."""

from __future__ import annotations

import _thread
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rmw_local.mismatch.passage import Converting
from rmw_local.transports.remote import RemoteServer

if TYPE_CHECKING:
    from rmw_local.mismatch.origin import Origin
    from rmw_local.service import Letter, ServiceClient, ServiceServer
    from rmw_local.transports.interface import Ask, Entity, OnOver, Serving, Transport

_MOST_REQUESTS: Final = 4096
"""The number of requests of which a server that adapts remembers by which definition they came."""


class ShownClient:
    """A client. It asks all servers under one gid. It is a `rmw_local.transports.interface.Presence`."""

    def __init__(self, client: ServiceClient, entity: Entity, transport: Transport, on_over: OnOver) -> None:
        self._client = client
        self._entity = entity
        self._transport = transport
        self._on_over = on_over
        self.asking = transport.ask(entity, self._on_reply, on_over)
        self._others: dict[str, Ask] = {}  # by the hashes of other definitions
        self.gid = self.asking.gid
        client.beyond = self._ask

    def close(self) -> None:
        """Withdraw it."""
        self.asking.close()

    def _ask(self, letter: Letter, servers: dict[ServiceServer, Any]) -> None:
        """Send a request once for each definition of the servers that are elsewhere."""
        data, stamp, _, number, *_ = letter
        remote = [(server, end) for server, end in servers.items() if isinstance(server, RemoteServer)]
        by_hash = {server.kind.type_hash: end for server, end in remote}
        own = self._entity.type_hash
        # The own definition is first: a server that adapts, too, takes what comes first.
        if by_hash.pop(own, None) is not None:
            reached = [(server.peer, server.gid) for server, _ in remote if server.kind.type_hash == own]
            self.asking.ask(data, number, stamp, reached)
        for type_hash, server in by_hash.items():
            converted = server.downgraded(data)
            if converted is None:
                self._on_over(number, "")
            else:
                self._other(type_hash, server)(converted, number, stamp)

    def _other(self, type_hash: str, server: Converting) -> Ask:
        ask = self._others.get(type_hash)
        if ask is None:
            entity = replace(self._entity, type_hash=type_hash)
            # A response does not say whose it is. It counts as that of the first server of its definition.
            on_reply = partial(self._on_reply, origin=server.incoming)
            ask = self._transport.ask_also(entity, self.gid, on_reply, self._on_over)
            self._others[type_hash] = ask
        return ask

    def _on_reply(self, data: bytes, number: int, stamp: int, origin: Origin | None = None) -> None:
        letter = data, stamp, self._client.gid, number
        self._client.accept(letter if origin is None else (*letter, origin))


class ShownServer:
    """A server. For each definition that it adapts it is shown again. It is a `Presence`, too."""

    def __init__(self, server: ServiceServer, entity: Entity, transport: Transport) -> None:
        self._server = server
        self._transport = transport
        self._others: dict[str, _Other] = {}  # by the hashes of other definitions
        self._came_by: _Ways | None = None  # once it adapts
        self._adapting = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self.serving = transport.serve(entity, self._on_request)
        self.gid = self.serving.gid
        server.beyond = self._reply
        server.drop = self._drop

    def adapt(self, entity: Entity, first: Converting) -> None:
        """Also answer clients of the entity's definition; `first` is one of them. Link's lock held."""
        type_hash = entity.type_hash
        if type_hash in self._others:
            return
        self._came_by = self._came_by or _Ways()
        with self._adapting:  # a response waits
            serving = self._transport.serve(entity, partial(self._on_other_request, type_hash, first))
            self._others[type_hash] = _Other(serving, first)

    def close(self) -> None:
        """Withdraw it."""
        for serving in self._servings():
            serving.close()

    def _servings(self) -> list[Serving]:
        return [self.serving, *(other.serving for other in tuple(self._others.values()))]

    def _on_request(self, data: bytes, number: int, stamp: int, gid: bytes) -> None:
        if self._came_by is None or self._came_by.is_new(gid, number, ""):
            self._server.accept((data, stamp, gid, number))
        else:
            self.serving.drop(number, gid)

    def _on_other_request(
        self, type_hash: str, first: Converting, data: bytes, number: int, stamp: int, gid: bytes
    ) -> None:
        assert self._came_by is not None
        if self._came_by.is_new(gid, number, type_hash):
            client = self._converting(gid) or first  # that is not announced, or not yet
            self._server.accept((data, stamp, gid, number, client.incoming))
        elif type_hash in self._others:
            self._others[type_hash].serving.drop(number, gid)

    def _converting(self, gid: bytes) -> Converting | None:
        """The client with this gid, if it has another definition."""
        found = self._server.clients.get(gid)
        return found if isinstance(found, Converting) else None

    def _reply(self, letter: Letter) -> bool:
        data, stamp, gid, number, *_ = letter
        if self._came_by is None:
            return self.serving.reply(data, number, stamp, gid)
        client = self._converting(gid)
        type_hash = self._came_by.way(gid, number)
        if type_hash is None:  # long ago
            type_hash = "" if client is None else client.end.kind.type_hash
        if not type_hash:
            return self.serving.reply(data, number, stamp, gid)
        with self._adapting:
            serving, first = self._others[type_hash]
        converted = (client or first).downgraded(data)
        if converted is None:
            serving.drop(number, gid)
            return True  # it was said
        return serving.reply(converted, number, stamp, gid)

    def _drop(self, letter: Letter) -> None:
        _, _, gid, number, *_ = letter
        for serving in self._servings():
            serving.drop(number, gid)


class _Other(NamedTuple):
    """Another definition, which a server adapts."""

    serving: Serving
    first: Converting


class _Ways:
    """By which definition requests came. From a client that adapts, too, one may come by two."""

    def __init__(self) -> None:
        self._lock = _thread.allocate_lock()
        self._ways: dict[tuple[bytes, int], str] = {}  # the hash of another definition, or nothing

    def is_new(self, gid: bytes, number: int, way: str) -> bool:
        """Note the way of a request by its client and number; False if it has come before."""
        with self._lock:
            if (gid, number) in self._ways:
                return False
            self._ways[gid, number] = way
            if len(self._ways) > _MOST_REQUESTS:
                del self._ways[next(iter(self._ways))]
        return True

    def way(self, gid: bytes, number: int) -> str | None:
        """The way that a request came, empty if by the own definition; None if that is forgotten."""
        return self._ways.get((gid, number))

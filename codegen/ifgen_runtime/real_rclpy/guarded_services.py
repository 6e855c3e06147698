"""Clients and servers of services that look at who is there before they send, and before they deliver.

A request goes to all servers, and rclpy does not tell whose a request or a response is. So all clients, and
all servers, must agree on a definition.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.reporting import Lru
from ifgen_runtime.real_rclpy.carriers import Client, Service, carrier_of, decoded, encoded
from ifgen_runtime.real_rclpy.endpoints import Part, parts_of
from ifgen_runtime.real_rclpy.peers import Others, Peer, applied


class _Hashes(NamedTuple):
    """The hashes of a service's two messages."""

    request: str
    response: str


class ServiceGuard:
    """Knows the definitions of the clients of a server, or of the servers of a client."""

    must_agree = True

    def __init__(self, node: Any, role: str, parts: tuple[Part, ...], policy: OnTypeMismatch) -> None:
        self.requests, self.responses = (Others(node, part) for part in parts)
        self._role = role
        self._policy = policy
        self._pending: Lru[str] = Lru()

    def see(self, others: Iterable[tuple[Part, Peer]]) -> None:
        """Take note of all who are there now."""
        found = tuple(others)
        for known in (self.requests, self.responses):
            known.see(peer for part, peer in found if part == known.part)

    def end(self) -> None:
        """Nothing is left to end."""

    def served(self) -> _Hashes | None:
        """The hashes that servers agree on, ours if none is there; None if they are refused."""
        requests, responses = self.requests.look(), self.responses.look()
        if len(requests) > 1 or len(responses) > 1:
            return None
        ours = _Hashes(self.requests.part.type_hash, self.responses.part.type_hash)
        theirs = _Hashes(
            *(next(iter(found), own) for found, own in zip((requests, responses), ours, strict=True))
        )
        if theirs == ours:
            return ours
        if not (requests and responses):
            return None  # discovered in part
        return None if self._is_refused(theirs) else theirs

    def sent(self, number: int, served: _Hashes) -> None:
        """Remember which definition the response to a request will have."""
        self._pending.set(number, served.response)

    def taken_response(self, data: bytes, number: int) -> Any:
        """The response to a request of ours; None if it is not to be delivered."""
        type_hash = self._pending.pop(number)
        if type_hash is None or self.responses.look() - {type_hash}:
            return None  # somebody else may have answered
        return decoded(data, type_hash, self.responses.part.cls)

    def taken_request(self, data: bytes, received: int) -> Any:
        """The request to call back with, received then [ns]; None if it is not to be delivered."""
        clients = self.requests.senders_at(received)
        response = self._response_hash()
        if len(clients) != 1 or response is None:
            return None
        (request,) = clients
        if self._is_refused(_Hashes(request, response)):
            return None
        return decoded(data, request, self.requests.part.cls)

    def response(self, response: Any) -> Any:
        """The response as it is sent: itself, or its bytes in another definition; None if it is refused."""
        part, type_hash = self.responses.part, self._response_hash()
        if type_hash is None or self._is_refused(_Hashes(self.requests.part.type_hash, type_hash)):
            return None
        return encoded(response, type_hash, part.cls)

    def _response_hash(self) -> str | None:
        """The hash that all clients read; None if they do not agree.

        What receives the response may be discovered a little later than what sends the request.
        """
        found = self.responses.look()
        return next(iter(found), self.responses.part.type_hash) if len(found) <= 1 else None

    def _is_refused(self, theirs: _Hashes) -> bool:
        parts = (self.requests.part, theirs.request), (self.responses.part, theirs.response)
        if all(part.type_hash == type_hash for part, type_hash in parts):
            return False
        return applied(self._policy, self._role, parts) is not OnTypeMismatch.ADAPT


class GuardedClient(Client):
    """rclpy's handle, with a guard."""

    guard: ServiceGuard
    unsent: Iterator[int]  # numbers of requests that nobody gets: below those of rcl

    def service_server_is_available(self) -> bool:
        """Whether a server is there, and none that is refused."""
        return super().service_server_is_available() and self.guard.served() is not None

    def send_request(self, request: Any) -> int:
        """Send a request as its servers understand it, and return its number.

        One that is refused is as one without a server: its future stays open.
        """
        served = self.guard.served()
        if served is None:
            return next(self.unsent)
        number = super().send_request(encoded(request, served.request, self.guard.requests.part.cls))
        self.guard.sent(number, served)
        return number

    def take_response(self, response_type: type[Any]) -> tuple[Any, Any]:
        """The header and the next response, as rclpy takes them; (None, None) if there is none to deliver."""
        header, carrier = super().take_response(carrier_of(self.guard.responses.part.cls))
        if header is None:
            return None, None
        response = self.guard.taken_response(carrier.data, header.request_id.sequence_number)
        return (None, None) if response is None else (header, response)


class GuardedService(Service):
    """rclpy's handle, with a guard."""

    guard: ServiceGuard

    def service_take_request(self, request_type: type[Any]) -> tuple[Any, Any]:
        """The next request and its header, as rclpy takes them; (None, None) if there is none to deliver."""
        carrier, header = super().service_take_request(carrier_of(self.guard.requests.part.cls))
        if header is None:
            return None, None
        request = self.guard.taken_request(carrier.data, header.received_timestamp)
        return (None, None) if request is None else (request, header)

    def service_send_response(self, response: Any, request_id: Any) -> None:
        """Send the response to a request, as clients understand it."""
        sent = self.guard.response(response)
        if sent is not None:
            super().service_send_response(sent, request_id)


def guarded_client(node: Any, name: str, qos: Any, cls: type[Any], policy: OnTypeMismatch) -> GuardedClient:
    """A handle for a client of a node. `name` is as its caller wrote it."""
    role = "service client"
    with node.handle:
        handle = GuardedClient(node.handle, cls, name, qos.get_c_qos_profile())
    handle.guard = ServiceGuard(node, role, parts_of(role, handle.service_name, cls, qos), policy)
    handle.unsent = itertools.count(-1, -1)
    return handle


def guarded_service(node: Any, name: str, qos: Any, cls: type[Any], policy: OnTypeMismatch) -> GuardedService:
    """A handle for a service of a node. `name` is as its caller wrote it."""
    role = "service server"
    with node.handle:
        handle = GuardedService(node.handle, cls, name, qos.get_c_qos_profile())
    handle.guard = ServiceGuard(node, role, parts_of(role, handle.name, cls, qos), policy)
    return handle

"""A service client that looks at who serves before it sends, and at who served before it answers."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.real_rclpy.carriers import carrier_of
from ifgen_runtime.mismatch.real_rclpy.converting import decoded, encoded
from ifgen_runtime.mismatch.real_rclpy.deciding import applied
from ifgen_runtime.mismatch.real_rclpy.endpoints import Part, parts_of
from ifgen_runtime.mismatch.real_rclpy.graph import Peer
from ifgen_runtime.mismatch.real_rclpy.handles import Client
from ifgen_runtime.mismatch.real_rclpy.others import Others
from ifgen_runtime.mismatch.remembered import Remembered


class _Served(NamedTuple):
    """The hashes of what servers take and return."""

    request: str
    response: str


class ClientGuard:
    """Knows the definitions of servers. A request goes to all of them, so they must agree."""

    def __init__(self, node: Any, parts: tuple[Part, ...], policy: OnTypeMismatch) -> None:
        self.requests, self.responses = (Others(node, part) for part in parts)
        self._policy = policy
        self._pending: Remembered[str] = Remembered()

    def see(self, others: Iterable[tuple[Part, Peer]]) -> None:
        """It looks by itself, at each request."""

    def end(self) -> None:
        """Nothing is left to end."""

    def served(self) -> _Served | None:
        """The hashes that servers agree on, ours if none is there; None if they are refused."""
        for others in (self.requests, self.responses):
            others.look()
        if len(self.requests.hashes) > 1 or len(self.responses.hashes) > 1:
            return None
        found = _Served(*(next(iter(o.hashes), o.part.type_hash) for o in (self.requests, self.responses)))
        known = (self.requests.part, found.request), (self.responses.part, found.response)
        if all(part.type_hash == type_hash for part, type_hash in known):
            return found
        if not (self.requests.hashes and self.responses.hashes):
            return None  # discovered in part
        return found if applied(self._policy, "service client", known) is OnTypeMismatch.ADAPT else None

    def sent(self, number: int, served: _Served) -> None:
        """Remember which definition the response to a request will have."""
        self._pending.set(number, served.response)

    def response(self, data: bytes, number: int) -> Any:
        """The response; None if it is not to be delivered."""
        type_hash = self._pending.pop(number)
        self.responses.look()
        if type_hash is None or self.responses.hashes - {type_hash}:
            return None  # somebody else may have answered
        return decoded(data, type_hash, self.responses.part.cls)


class GuardedClient(Client):
    """rclpy's handle, with a guard."""

    guard: ClientGuard
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
        response = self.guard.response(carrier.data, header.request_id.sequence_number)
        return (None, None) if response is None else (header, response)


def guarded_client(node: Any, name: str, qos: Any, cls: type[Any], policy: OnTypeMismatch) -> GuardedClient:
    """A handle for a client of a node. `name` is as its caller wrote it."""
    with node.handle:
        handle = GuardedClient(node.handle, cls, name, qos.get_c_qos_profile())
    handle.guard = ClientGuard(node, parts_of("service client", handle.service_name, cls, qos), policy)
    handle.unsent = itertools.count(-1, -1)
    return handle

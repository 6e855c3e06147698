"""A service server that looks at each request's client before it calls back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ifgen_runtime.mismatch.policy import OnTypeMismatch
from ifgen_runtime.mismatch.real_rclpy.carriers import carrier_of
from ifgen_runtime.mismatch.real_rclpy.converting import decoded, encoded
from ifgen_runtime.mismatch.real_rclpy.deciding import applied
from ifgen_runtime.mismatch.real_rclpy.endpoints import Part, parts_of
from ifgen_runtime.mismatch.real_rclpy.graph import Peer
from ifgen_runtime.mismatch.real_rclpy.handles import Service
from ifgen_runtime.mismatch.real_rclpy.others import Others
from ifgen_runtime.mismatch.real_rclpy.taking import key_of, participant_of


class ServiceGuard:
    """Knows the definitions of clients, each by its participant of DDS, which is what a request tells."""

    def __init__(self, node: Any, parts: tuple[Part, ...], policy: OnTypeMismatch) -> None:
        self.requests, self.responses = (Others(node, part, participant_of) for part in parts)
        self._policy = policy

    def see(self, others: Iterable[tuple[Part, Peer]]) -> None:
        """Take note of all clients that are there now."""
        found = tuple(others)
        for known in (self.requests, self.responses):
            known.see(peer for part, peer in found if part == known.part)

    def end(self) -> None:
        """Nothing is left to end."""

    def request(self, data: bytes, request_id: Any) -> Any:
        """The request to call back with; None if it is not to be delivered."""
        client = participant_of(key_of(request_id))
        type_hash = self.requests.hash_of(client)
        # What receives the response may be discovered a little later.
        response_hash = self.responses.hash_of(client) or self.responses.part.type_hash
        if type_hash is None or self._is_refused(self.requests.part, type_hash):
            return None
        if self._is_refused(self.responses.part, response_hash):
            return None
        return decoded(data, type_hash, self.requests.part.cls)

    def response(self, response: Any, request_id: Any) -> Any:
        """The response as it is sent: itself, or its bytes in another definition; None if it is refused."""
        part = self.responses.part
        type_hash = self.responses.hash_of(participant_of(key_of(request_id))) or part.type_hash
        return None if self._is_refused(part, type_hash) else encoded(response, type_hash, part.cls)

    def _is_refused(self, part: Part, type_hash: str) -> bool:
        if type_hash == part.type_hash:
            return False
        return applied(self._policy, "service server", [(part, type_hash)]) is OnTypeMismatch.REFUSE


class GuardedService(Service):
    """rclpy's handle, with a guard."""

    guard: ServiceGuard

    def service_take_request(self, request_type: type[Any]) -> tuple[Any, Any]:
        """The next request and its header, as rclpy takes them; (None, None) if there is none to deliver."""
        carrier, header = super().service_take_request(carrier_of(self.guard.requests.part.cls))
        if header is None:
            return None, None
        request = self.guard.request(carrier.data, header.request_id)
        return (None, None) if request is None else (request, header)

    def service_send_response(self, response: Any, request_id: Any) -> None:
        """Send the response to a request, as its client understands it."""
        sent = self.guard.response(response, request_id)
        if sent is not None:
            super().service_send_response(sent, request_id)


def guarded_service(node: Any, name: str, qos: Any, cls: type[Any], policy: OnTypeMismatch) -> GuardedService:
    """A handle for a service of a node. `name` is as its caller wrote it."""
    with node.handle:
        handle = GuardedService(node.handle, cls, name, qos.get_c_qos_profile())
    handle.guard = ServiceGuard(node, parts_of("service server", handle.name, cls, qos), policy)
    return handle

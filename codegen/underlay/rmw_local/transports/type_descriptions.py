"""The way of questions to `~/get_type_description` of nodes in other processes.

Whoever asks is not in the graph: a question is one query of the transport, without an endpoint.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from ifgen_runtime.mismatch.type_description_client import Answers, Connection, Definitions, Question

from rmw_local.message import service_type
from rmw_local.transports.interface import Entity, Kind

if TYPE_CHECKING:
    from rmw_local.domain import Domain
    from rmw_local.mismatch.encounter import Party
    from rmw_local.transports.interface import Transport

_POLL: Final = 0.01
"""Seconds between two looks at what has come."""

_LONGEST: Final = 2**18  # bytes of an answer


def definitions(domain: Domain, transport: Transport, is_over: Callable[[], bool]) -> Definitions:
    """The definitions of nodes in other processes. Once everything `is_over`, nothing is waited for."""

    @contextmanager
    def connect() -> Generator[Connection]:
        yield _Connection(domain, transport)

    return Definitions(connect, is_over)


def question(party: Party) -> Question:
    """The question for the definition of an endpoint in another process."""
    return Question(party.node.full_name, party.kind.name, party.kind.type_hash)


class _Connection:
    """A connection through the transport."""

    def __init__(self, domain: Domain, transport: Transport) -> None:
        self._domain = domain
        self._transport = transport
        # A package of its own, which not every program has loaded.
        self._kind = service_type(import_module("type_description_interfaces.srv").GetTypeDescription)

    def now(self) -> float:
        """The time of the machine [s]."""
        return time.monotonic()

    def wait(self, seconds: float) -> None:
        """Sleep until the next look."""
        time.sleep(min(seconds, _POLL))

    def send(self, question: Question, patience: float) -> Answers | None:
        """Ask all nodes of this name, once there is one."""
        kind = self._kind
        if not self._is_served(question.service):
            return None
        server = Entity(
            Kind.SERVER,
            *(0, 0, "", "", ""),  # whose it is does not matter
            name=question.service,
            type_name=kind.name,
            type_hash=kind.type_hash,
        )
        request = kind.request.serialize(question.fill(kind.cls.Request()))
        come = self._transport.inquire(server, request, max(patience, _POLL))

        def answers() -> list[Any]:
            is_there = self._is_served(question.service)  # first: what it sent before it went is there then
            return [self._response(data) for data in come()] or ([] if is_there else [None])

        return answers

    def _response(self, data: bytes) -> Any:
        """The response in bytes that may be anything; None if they are none."""
        try:
            return self._kind.response.deserialize(data) if len(data) <= _LONGEST else None
        except Exception:  # whatever they are, the warning is to come
            return None

    def _is_served(self, name: str) -> bool:
        with self._domain.lock:
            service = self._domain.services.get(name)
            servers = service.servers if service is not None else ()
            return any(each.is_remote and each.kind.type_hash == self._kind.type_hash for each in servers)

"""Reports endpoints of two processes whose definitions differ, after asking the other one's node for its own.

Whoever asks `~/get_type_description` here is not in the graph: a question is one query of the transport,
without an endpoint.
"""

from __future__ import annotations

import _thread
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final
from weakref import WeakKeyDictionary

from ifgen_runtime.mismatch.type_description_client import Answers, Connection, Definitions, Question

from rmw_local.message import service_type
from rmw_local.notices import say
from rmw_local.transports.interface import Entity, Kind

if TYPE_CHECKING:
    from ifgen_runtime.mismatch.reporting import Definition
    from ifgen_runtime.mismatch.type_description_client import Definitions

    from rmw_local.domain import Domain
    from rmw_local.graph import GraphNode
    from rmw_local.mismatch.encounter import Encounter, Party
    from rmw_local.transports.background import Background
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


_MOST_PENDING: Final = 1000
"""The number of encounters with other definitions that wait to be reported."""


class Reporter:
    """Asks for the other definitions, and warns, on a thread that lives while there is something to report.

    It is a thread of its own because listeners and loggers are code of users, and answers take time.
    """

    def __init__(self, domain: Domain, transport: Transport, background: Background) -> None:
        self._background = background
        self._pending: deque[Encounter] = deque(maxlen=_MOST_PENDING)
        self._lock = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._is_reporting = self._is_over = False
        self._definitions: Definitions | None = None  # once there is something to ask
        self._domain = domain
        self._transport = transport
        self._actions: WeakKeyDictionary[GraphNode, WeakKeyDictionary[GraphNode, set[str]]]
        self._actions = WeakKeyDictionary()

    def report(self, encounters: Iterable[Encounter]) -> None:
        """Report them later."""
        with self._lock:
            self._pending.extend(encounters)
            begins = bool(self._pending) and not (self._is_reporting or self._is_over)
            self._is_reporting = self._is_reporting or begins
        if begins:
            self._background.start(self._report_all)

    def close(self) -> None:
        """Say nothing more, once the warning that is being made is finished."""
        self._is_over = True

    def _report_all(self) -> None:
        # Late, and here: definitions hardly ever differ.

        if self._definitions is None:
            self._definitions = definitions(self._domain, self._transport, lambda: self._is_over)
        answers = self._definitions
        while batch := self._taken():
            answers.ask(question(each.theirs) for each in batch)
            for encounter in self._without_repetitions(batch):
                self._report(encounter, lambda party: answers.get(question(party)))

    def _taken(self) -> list[Encounter]:
        """All that is to be reported; with nothing, the thread ends."""
        with self._lock:
            batch = [] if self._is_over else list(self._pending)
            self._pending.clear()
            self._is_reporting = bool(batch)
        return batch

    def _report(self, encounter: Encounter, elsewhere: Callable[[Party], Definition | None]) -> None:
        from rmw_local.mismatch.reporting import report  # late: only nodes that differ need it

        if self._is_over or encounter.mine.node.participant.has_ended:
            return
        try:
            report([encounter], elsewhere)
        except Exception as error:  # code of users: the next warning is to come, whatever it does
            say(f"a listener for definitions that differ failed with {error!r}")

    def _without_repetitions(self, batch: Iterable[Encounter]) -> Iterator[Encounter]:
        """All but further parts of an action of which a pair of nodes has been reported."""
        from rmw_local.mismatch.reporting import part_of_action  # late: as above

        for encounter in sorted(batch, key=lambda each: part_of_action(each)[1]):
            action, _ = part_of_action(encounter)
            if action:
                by_peer = self._actions.setdefault(encounter.mine.node, WeakKeyDictionary())
                reported = by_peer.setdefault(encounter.theirs.node, set())
                if action in reported:
                    continue
                reported.add(action)
            yield encounter

"""Asks nodes of other processes for their definitions, by `~/get_type_description`.

Whoever asks is not in the graph: a question is one query of the transport, without an endpoint.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from importlib import import_module
from itertools import groupby, islice
from typing import TYPE_CHECKING, Final, NamedTuple

from ifgen_runtime.mismatch.remembered import Once, Remembered
from ifgen_runtime.mismatch.sides import Definition, definition_from
from ifgen_runtime.type_description import hash_of

from rmw_local.message import service_type
from rmw_local.transports.interface import Entity, Kind

if TYPE_CHECKING:
    from rmw_local.domain import Domain
    from rmw_local.mismatch.encounter import Party
    from rmw_local.transports.interface import Transport

    Answers = Callable[[], Iterable[bytes]]  # what has come since the last call

_PATIENCE: Final = 0.5
"""Seconds that all answers have: the warning is to come within one."""

_POLL: Final = 0.01
"""Seconds between two looks at what has come."""

_AT_ONCE: Final = 16
"""The number of questions that are asked together. Warnings about other types go without the detail."""

_NODES: Final = 3
"""The number of nodes that are asked for one definition at once, as one of them may be silent."""

_LONGEST: Final = 2**18  # bytes of an answer
_MOST_DEFINITIONS: Final = 128


class Question(NamedTuple):
    """A node that has a definition, and which it is."""

    node: str
    type_name: str
    type_hash: str


class Asker:
    """Asks each node for each definition once, and remembers what it has said. One thread uses it."""

    def __init__(self, domain: Domain, transport: Transport, is_over: Callable[[], bool]) -> None:
        """While it waits for answers, it looks whether everything `is_over`."""
        self._domain = domain
        self._transport = transport
        self._is_over = is_over
        # A package of its own, which not every program has loaded.
        self._kind = service_type(import_module("type_description_interfaces.srv").GetTypeDescription)
        self._asked = Once()
        self._by_hash: Remembered[Definition] = Remembered(_MOST_DEFINITIONS)  # those that fit their hashes
        self._lies: Remembered[Definition] = Remembered(_MOST_DEFINITIONS)  # by question

    def ask(self, parties: Iterable[Party]) -> None:
        """Ask for the definitions of endpoints in other processes, and wait for the answers, but not long."""
        new = (each for each in self._questions(parties) if self._asked.is_new(each))
        asked = list(islice(new, _AT_ONCE))
        if asked:
            self._converse(asked)

    def definition(self, party: Party) -> Definition | None:
        """The definition of an endpoint, if its node or another one has sent it. It may be a lie."""
        question = _question(party)
        return self._by_hash.get(question.type_hash) or self._lies.get(question)

    def _questions(self, parties: Iterable[Party]) -> list[Question]:
        """The questions worth asking: to a few nodes with each unknown definition, first to one of each."""
        unknown = sorted(
            {_question(each) for each in parties if self._by_hash.get(each.kind.type_hash) is None},
            key=lambda question: question.type_hash,
        )
        ranked = [
            (rank, question)
            for type_hash, group in groupby(unknown, key=lambda question: question.type_hash)
            if type_hash
            for rank, question in zip(range(_NODES), group, strict=False)
        ]
        return [question for _, question in sorted(ranked)]

    def _converse(self, asked: list[Question]) -> None:
        unsent, unanswered = list(asked), set(asked)
        answers: dict[Question, Answers] = {}
        until = time.monotonic() + _PATIENCE
        while unanswered and time.monotonic() < until and not self._is_over():
            for question in tuple(unsent):
                if self._can_be_asked(question.node):
                    unsent.remove(question)
                    answers[question] = self._sent(question, until - time.monotonic())
            time.sleep(_POLL)
            for question, come in answers.items():
                for data in come():
                    unanswered.discard(question)
                    self._keep(question, data)
            unanswered = {each for each in unanswered if self._by_hash.get(each.type_hash) is None}

    def _can_be_asked(self, node: str) -> bool:
        wanted = self._kind.type_hash
        with self._domain.lock:
            service = self._domain.services.get(_service_of(node))
            servers = service.servers if service is not None else ()
            return any(each.is_remote and each.kind.type_hash == wanted for each in servers)

    def _sent(self, question: Question, patience: float) -> Answers:
        kind = self._kind
        request = kind.cls.Request(
            type_name=question.type_name, type_hash=question.type_hash, include_type_sources=True
        )
        server = Entity(
            Kind.SERVER,
            *(0, 0, "", "", ""),  # whose it is does not matter
            name=_service_of(question.node),
            type_name=kind.name,
            type_hash=kind.type_hash,
        )
        return self._transport.inquire(server, kind.request.serialize(request), max(patience, _POLL))

    def _keep(self, question: Question, data: bytes) -> None:
        """Remember what a node has said; of other nodes, only what fits the hash is believed."""
        if len(data) > _LONGEST:
            return
        try:
            definition = definition_from(self._kind.response.deserialize(data))
            is_true = hash_of(definition.document) == question.type_hash
        except Exception:  # the node does not know, or has sent whatever it likes: the warning is to come
            return
        if is_true:
            self._by_hash.set(question.type_hash, definition)
        else:
            self._lies.set(question, definition)


def _question(party: Party) -> Question:
    return Question(party.node.full_name, party.kind.name, party.kind.type_hash)


def _service_of(node: str) -> str:
    return f"{node}/get_type_description"

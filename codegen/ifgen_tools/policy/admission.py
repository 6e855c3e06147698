"""Whether the nodes of a manifest may join a system: the rules of systems, about both together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, TypeAlias

from ifgen.diagnostics import Diagnostic

from ifgen_tools.beside import session_beside
from ifgen_tools.system.manifest import Manifest
from ifgen_tools.system.model import NodeInstance, System
from ifgen_tools.system.rules import check
from ifgen_tools.system.running import of_graph
from ifgen_tools.verbs import TransportChoice

Outcome: TypeAlias = Literal["accepted", "rejected", "unclear"]
_CODES: Final[dict[Outcome, int]] = {"accepted": 0, "rejected": 1, "unclear": 2}
_REASONS: Final = {
    "system-type": "type",
    "system-hash": "major",
    "system-version": "major",
    "system-qos": "qos",
    "system-near-name": "topic",
    "system-namespace": "topic",
    "system-no-server": "no provider",
    "system-required": "no provider",
    "system-two-servers": "two providers",
    "system-same-node": "two nodes",
}
"""Words for rules that a gate knows; the others keep their names."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why nodes may not join, or why nobody can tell: a word, and what is wrong."""

    word: str
    what: str


@dataclass(frozen=True, slots=True)
class Verdict:
    """The outcome with its reasons, and how many nodes were looked at."""

    outcome: Outcome
    reasons: tuple[Reason, ...]
    nodes: int

    @property
    def code(self) -> int:
        """The exit code: 0 accepted, 1 rejected, 2 unclear."""
        return _CODES[self.outcome]

    def as_text(self) -> str:
        """The verdict in lines."""
        lines = [f"{each.word}: {each.what}" for each in self.reasons]
        return "\n".join([*lines, f"{self.outcome}: {self.nodes} node{'' if self.nodes == 1 else 's'}"])

    def as_json(self) -> dict[str, Any]:
        """The verdict for programs."""
        reasons = [{"reason": each.word, "what": each.what} for each in self.reasons]
        return {"outcome": self.outcome, "nodes": self.nodes, "reasons": reasons}


def described(manifest: Manifest) -> System:
    """The system of a manifest, whose open ends stay open."""
    return System(manifest.nodes)


def running(transport: TransportChoice) -> System:
    """The system that runs now. Raises UsageError if there is no such transport."""
    with session_beside([], transport) as session:
        return of_graph(session.graph())


def judge(candidate: Manifest, system: System, *, complete: bool = False) -> Verdict:
    """Whether the candidate's nodes may join; with `complete` everything that they need must be there.

    What is wrong in the system already is no reason. A node of the same name is taken for the older version
    of the candidate's, and leaves.
    """
    names = {node.name for node in candidate.nodes}
    staying = tuple(node for node in system.nodes if node.name not in names)
    before = _errors(System(staying), complete=complete)
    nodes = tuple(replace(node, kind="running") for node in (*staying, *candidate.nodes))
    found = _errors(System(nodes), complete=complete)
    known = {each.message for each in before}
    reasons = [
        Reason(_REASONS.get(each.rule, each.rule), each.message)
        for each in found
        if each.message not in known
    ]
    if reasons:
        return Verdict("rejected", tuple(reasons), len(candidate.nodes))
    unclear = [*_open(candidate), *_without_hash(candidate, staying)]
    outcome: Outcome = "unclear" if unclear else "accepted"
    return Verdict(outcome, tuple(unclear), len(candidate.nodes))


def _errors(system: System, *, complete: bool) -> list[Diagnostic]:
    return [each for each in check(system, complete=complete) if each.severity == "error"]


def _open(candidate: Manifest) -> Iterable[Reason]:
    for name in candidate.open_ends:
        yield Reason("no document", f"nobody says what {name} offers and needs")


def _without_hash(candidate: Manifest, staying: Iterable[NodeInstance]) -> Iterable[Reason]:
    """Topics that both have, where one of the two does not say its definition."""
    others = {(end.name, end.type_name): end for node in staying for end in node.endpoints}
    told: set[str] = set()
    for end in candidate.endpoints:
        other = others.get((end.name, end.type_name))
        is_topic = end.category.folder == "msg"
        if other is None or not is_topic or (end.type_hash and other.type_hash) or end.name in told:
            continue
        told.add(end.name)
        lacking = end.node if not end.type_hash else other.node
        yield Reason("no definition", f"{lacking} does not say which {end.type_name} it has on {end.name}")

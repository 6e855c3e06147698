"""The results of exchanges: a cell of the table for each implementation and each feature."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Feature(StrEnum):
    """A kind of exchange."""

    TOPIC = "topic"
    SERVICE = "service"
    ACTION = "action"
    PARAMETER = "parameter"
    GRAPH = "graph"
    TRANSIENT_LOCAL = "transient local"
    IMAGE = "large image"
    BUFFERS = "Lyrical's buffer keys"


class Outcome(StrEnum):
    """The result of one check."""

    WORKS = "works"
    FAILS = "fails"
    """It should work."""
    LACKING = "lacking"
    """The other implementation does not offer it, or does it otherwise than the conventions say."""
    ABSENT = "absent"
    """The other implementation is not installed, or too old."""


@dataclass(frozen=True, slots=True)
class Check:
    """One exchange, in one direction. `reason` says why it does not work."""

    name: str
    outcome: Outcome
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Cell:
    """All checks of a feature with one implementation."""

    peer: str
    feature: Feature
    checks: tuple[Check, ...]

    @property
    def word(self) -> str:
        """The word in the table."""
        found = {check.outcome for check in self.checks}
        if Outcome.FAILS in found:
            return "FAILS"
        if found == {Outcome.WORKS}:
            return "ok"
        return "part" if Outcome.WORKS in found else "-"


@dataclass(frozen=True, slots=True)
class Row:
    """Everything about one implementation. `versions` are those of its distributions, the first its own."""

    peer: str
    versions: dict[str, str]
    cells: tuple[Cell, ...]

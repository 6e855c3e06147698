"""Reports of endpoints that met that their definitions differ: once a pair, with no lock held."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import Mismatch, Side, definition_of, short

from rmw_local import report as log
from rmw_local.message import type_name
from rmw_local.service import ServiceEndpoint

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ifgen_runtime.mismatch.reporting import Definition

    from rmw_local.mismatch.encounter import Encounter, Party

_ACTION = "/_action/"
_SUFFIXES = ("SendGoal", "GetResult", "FeedbackMessage")  # of the names of parts
_PARTS = ("SendGoalService", "GetResultService", "FeedbackMessage")


def report(
    encounters: Iterable[Encounter], elsewhere: Callable[[Party], Definition | None] = lambda _: None
) -> None:
    """Tell the listener, and log as the nodes whose policies were applied.

    `elsewhere` knows the definitions of endpoints in other processes, as far as they are known.
    """
    for encounter in encounters:
        subject = _Subject(encounter, elsewhere)
        if subject.is_said_here:
            _report(subject.mismatch(), encounter)


def part_of_action(encounter: Encounter) -> tuple[str, int]:
    """The action that my endpoint belongs to, empty if none, and the number of the part."""
    name, separator, _ = encounter.mine.name.partition(_ACTION)
    action, part = encounter.mine.kind.action, encounter.mine.kind.name.rpartition("_")[2]
    return (name, _SUFFIXES.index(part)) if separator and action and part in _SUFFIXES else ("", 0)


def _report(mismatch: Mismatch, encounter: Encounter) -> None:
    def remarks(said: str) -> str:
        text = ""
        lacks_adapter = encounter.wanted == "adapt" != encounter.policy
        if lacks_adapter and not (encounter.crosses_processes and _cannot_adapt(mismatch)):
            text += _missing(mismatch, said)
        if encounter.crosses_processes and not encounter.adapts:
            text += _between_processes(mismatch, encounter)
        return text

    node = encounter.mine.node
    text = reporting.report(mismatch, node.participant.warning_limit, remarks)
    if text:
        log.say(node, text, is_warning=mismatch.policy != "adapt")


def _between_processes(mismatch: Mismatch, encounter: Encounter) -> str:
    """The consequence for two processes, where mine does not adapt."""
    theirs = mismatch.theirs.role.removeprefix("service ")  # subscription, client or server
    can_adapt = mismatch.mine.role != "subscription" and mismatch.kind != "action"
    if isinstance(encounter.theirs, ServiceEndpoint) and encounter.theirs.refuses:
        return f"\n{mismatch.theirs.node} refuses other definitions, so nothing is exchanged."
    if can_adapt and (mismatch.kind == "topic" or encounter.wanted != "refuse"):
        return f"\nBetween processes only equal definitions meet, unless the {theirs} adapts."
    return "\nBetween processes only equal definitions meet, so nothing is exchanged."


def _cannot_adapt(mismatch: Mismatch) -> bool:
    """Whether mine could not use an adapter between processes."""
    return mismatch.kind == "action" or mismatch.mine.role == "publisher"


def _missing(mismatch: Mismatch, said: str) -> str:
    """The reason why a node refuses that is to adapt; `said` may have the command that helps."""
    adapter = "adapter" if mismatch.kind == "topic" else "adapter with `downgrade`"
    command = f"ifgen adapt {mismatch.type_name} --from {short(mismatch.theirs.type_hash)}"
    hint = "" if command in said else f": `{command}` writes one"
    return f"\n{mismatch.mine.node} is to adapt, but no {adapter} was registered when the two met{hint}"


class _Subject:
    """The topic or service of two endpoints, or the action that they are parts of."""

    def __init__(self, encounter: Encounter, elsewhere: Callable[[Party], Definition | None]) -> None:
        self._encounter = encounter
        self._elsewhere = elsewhere
        mine, theirs = encounter.mine, encounter.theirs
        self._classes: tuple[type[Any], type[Any]] = (mine.kind.cls, theirs.kind.cls)
        self._kind = "service" if isinstance(mine, ServiceEndpoint) else "topic"
        self._name, separator, _ = mine.name.partition(_ACTION)
        self.is_said_here = True
        if separator and mine.kind.action and theirs.kind.action:
            self._kind = "action"
            self._classes = (mine.kind.action, theirs.kind.action)
            self.is_said_here = mine.kind.cls is _first_that_differs(*self._classes)
        elif encounter.crosses_processes and part_of_action(encounter)[0]:
            self._kind = "action"  # of theirs, only the hash of a part is known
        else:
            self._name = mine.name

    def mismatch(self) -> Mismatch:
        """It as a value."""
        mine, theirs = self._encounter.mine, self._encounter.theirs
        return Mismatch(
            self._kind,
            self._name,
            type_name(self._classes[0]),
            self._encounter.policy,
            self._side(mine, self._classes[0]),
            self._side(theirs, self._classes[1]),
        )

    def _side(self, party: Party, cls: type[Any]) -> Side:
        role = party.role
        if self._kind == "action":
            role = "action server" if role in ("publisher", "service server") else "action client"
        if party.is_remote:
            return Side(party.node.full_name, role, party.kind.type_hash, self._elsewhere(party))
        try:
            definition = definition_of(cls)
        except Exception:  # whoever made the class, it must not keep a node from being made
            definition = None
        return Side(party.node.full_name, role, getattr(cls, "__type_hash__", ""), definition)


def _first_that_differs(mine: type[Any], theirs: type[Any]) -> type[Any] | None:
    """My class of the first part of an action that differs: one warning for all of them is enough."""
    for part in _PARTS:
        my_part, their_part = getattr(mine.Impl, part), getattr(theirs.Impl, part)
        if my_part.__type_hash__ != their_part.__type_hash__:
            cls: type[Any] = my_part
            return cls
    return None

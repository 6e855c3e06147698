"""A system as rules look at it, by its names, and findings with a caret in every file that takes part."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, Label, Severity, Span
from ifgen.nodl.model import Category, NodeDescription

from ifgen_tools.system.model import Endpoint, NodeInstance, System

SOURCES = (Category.PUBLISHER, Category.SERVICE_SERVER, Category.ACTION_SERVER)
"""The sides that provide: the others need."""

ALWAYS_THERE = ("/tf", "/tf_static", "/clock", "/rosout", "/parameter_events")
"""Topics that nodes use through their libraries, whatever their documents say."""

_MAX_EDITS = 2


@dataclass(frozen=True)
class Meeting:
    """All ends of one topic, service or action."""

    name: str
    folder: str
    providers: tuple[Endpoint, ...]
    users: tuple[Endpoint, ...]

    @property
    def ends(self) -> tuple[Endpoint, ...]:
        """The ends of both sides."""
        return self.providers + self.users

    def pairs(self) -> Iterator[tuple[Endpoint, Endpoint]]:
        """Each provider with each user of the same type."""
        for provider in self.providers:
            yield from ((provider, user) for user in self.users if user.type_name == provider.type_name)


@dataclass(frozen=True)
class View:
    """A system to be checked; `complete` says that everything must be described and connected."""

    system: System
    complete: bool = False

    @cached_property
    def meetings(self) -> tuple[Meeting, ...]:
        """The ends of each name, by name."""

        def place(endpoint: Endpoint) -> tuple[str, str]:
            return endpoint.name, endpoint.category.folder

        found: list[Meeting] = []
        for (name, folder), group in groupby(sorted(self.system.endpoints, key=place), key=place):
            ends = tuple(group)
            providers = tuple(end for end in ends if end.category in SOURCES)
            users = tuple(end for end in ends if end.category not in SOURCES)
            found.append(Meeting(name, folder, providers, users))
        return tuple(found)

    @cached_property
    def names(self) -> dict[tuple[str, str], Meeting]:
        """The meetings by name and folder."""
        return {(meeting.name, meeting.folder): meeting for meeting in self.meetings}

    @cached_property
    def nodes(self) -> dict[str, NodeInstance]:
        """The nodes by their full names."""
        return {node.name: node for node in reversed(self.system.nodes)}

    @cached_property
    def is_open(self) -> bool:
        """Whether somebody may offer or need what no document says."""
        return bool(self.system.open_ends)

    @cached_property
    def described(self) -> tuple[tuple[NodeInstance, NodeDescription], ...]:
        """The nodes that have a document."""
        return tuple((node, node.description) for node in self.system.nodes if node.description)

    @property
    def severity(self) -> Severity:
        """The severity of what is wrong only if nobody else comes."""
        return "error" if self.complete else "warning"

    def about(self, endpoint: Endpoint, text: str) -> Iterator[Label]:
        """The places of an endpoint: in its document, and in the launch file that renames or starts it."""
        remap = endpoint.remap.span if endpoint.remap else None
        if remap:
            yield Label(remap, text)
        if endpoint.span:
            yield Label(endpoint.span, "declared here" if remap else text)
        node = self.nodes.get(endpoint.node)
        if node and node.span and not remap:
            yield Label(node.span, f"{node.name} starts here")


def finding(
    *,
    rule: str,
    message: str,
    labels: Iterable[Label | None],
    help: str | None = None,
    severity: Severity = "error",
) -> Diagnostic:
    """A finding whose first label is the primary one; places that are not known are left out."""
    places: dict[tuple[object, int], Label] = {}
    for label in labels:
        if label is not None:
            places.setdefault((label.span.source.path, label.span.start), label)
    known = list(places.values())
    return Diagnostic(rule, message, known[0] if known else None, tuple(known[1:]), help, severity)


def at(span: Span | None, text: str = "") -> Label | None:
    """A label at a place; None where there is none."""
    return Label(span, text) if span else None


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The name among these that differs from another by a slip of the hand; None if none does."""
    close = [(edits(name, other), other) for other in known if is_near(name, other)]
    return min(close)[1] if close else None


def is_near(one: str, other: str) -> bool:
    """Whether two names of the graph differ by a slip: not by a number, nor by a word such as `l` and `r`."""
    if one == other or abs(len(one) - len(other)) > _MAX_EDITS:
        return False
    first, second = _words(one), _words(other)
    if len(first) == len(second):
        differing = [pair for pair in zip(first, second, strict=True) if pair[0] != pair[1]]
        return len(differing) == 1 and all(_is_slip(*pair) for pair in differing)
    return "".join(first) == "".join(second)


def _words(name: str) -> list[str]:
    return [word for word in re.split(r"[/_]+", name) if word]


def _is_slip(one: str, other: str) -> bool:
    if min(len(one), len(other)) < 3 or re.sub(r"\d", "", one) == re.sub(r"\d", "", other):
        return False
    return edits(one, other) <= (1 if min(len(one), len(other)) < 5 else _MAX_EDITS)


def edits(one: str, other: str) -> int:
    """The least number of letters to add, drop, replace or swap to get from one text to the other."""
    before: Sequence[int] = ()
    last = list(range(len(other) + 1))
    for i, letter in enumerate(one):
        row = [i + 1]
        for j, wanted in enumerate(other):
            cost = min(row[j] + 1, last[j + 1] + 1, last[j] + (letter != wanted))
            if i and j and letter == other[j - 1] and one[i - 1] == wanted:
                cost = min(cost, before[j - 1] + 1)
            row.append(cost)
        before, last = last, row
    return last[-1]


def suggestion(name: str, known: Iterable[str]) -> str | None:
    """`did you mean ...?`, or None."""
    listed = sorted(set(known))
    if near := nearest(name, listed):
        return f"did you mean `{near}`?"
    return did_you_mean(name, listed)

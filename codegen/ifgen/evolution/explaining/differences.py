"""The differences between two definitions of a type that have different hashes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import islice
from typing import Final

from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.evolution.compare import between
from ifgen.evolution.edits import Category
from ifgen.evolution.explaining.definitions import Installed, Known
from ifgen.evolution.words import diagnostic

_MOST_VALUES: Final = 20_000
"""Values in a message, those of nested messages included: more would take too long to compare."""

_MOST_CHANGES: Final = 1_000

TOO_LARGE: Final = "the definitions are too large to compare while programs run"


@dataclass(frozen=True, slots=True)
class Differences:
    """The changes between two definitions that change the hash, and what to say besides."""

    changes: tuple[Diagnostic, ...] = ()
    remark: str = ""


def differences(old: Known, new: Known, installed: Installed) -> Differences:
    """The differences from `old` to `new`, with places in files where these can be found."""
    if not isinstance(old.described, type(new.described)):
        return Differences(remark=f"one is a {_kind(old.described)}, the other a {_kind(new.described)}")
    if any(_is_large(known.described, known.registry) for known in (old, new)):
        return Differences(remark=TOO_LARGE)
    sides = old.described, new.described, old.registry, new.registry
    every = islice(map(diagnostic, between(*sides, with_constants=False)), _MOST_CHANGES)
    found = [change for change in every if change is not None]
    changes = [change for change in found if Category.HASH in change.breaks]
    located = _Located(installed)
    if changes:
        return Differences(tuple(map(located.diagnostic, changes)))
    what = "only in defaults, which change no hash" if found else "in nothing that their fields show"
    return Differences(remark=f"the two definitions differ {what}")


def _kind(described: Interface) -> str:
    return type(described).__name__.lower()


class _Located:
    """Diagnostics with the paths of files: what was compared are texts, wherever they came from."""

    def __init__(self, installed: Installed) -> None:
        self._installed = installed
        self._sources: dict[Source, Source] = {}

    def diagnostic(self, change: Diagnostic) -> Diagnostic:
        """The same diagnostic, with these paths for all places of this side."""
        primary = self._label(change.primary) if change.primary is not None else None
        return replace(change, primary=primary, secondary=tuple(map(self._label, change.secondary)))

    def _label(self, label: Label) -> Label:
        source = label.span.source
        if source.revision is not None or source.path.is_absolute():
            return label
        if source not in self._sources:
            self._sources[source] = self._installed.located(source)
        return Label(Span(self._sources[source], label.span.start, label.span.end), label.text)


def _is_large(described: Interface, registry: Registry) -> bool:
    """Whether the messages of a type hold more values than can be compared in a moment."""
    sizes: dict[str, int] = {}

    def size(message: Message) -> int:
        name = message.type_name
        if name not in sizes:
            nested = [registry.message(type_.type_name) for _, type_ in references(message)]
            sizes[name] = len(message.fields) + sum(map(size, nested))
        return sizes[name]

    parts = (described,) if isinstance(described, Message) else described.messages
    return sum(map(size, parts)) > _MOST_VALUES

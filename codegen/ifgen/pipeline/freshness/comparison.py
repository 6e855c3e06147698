"""What need not be generated: the state that a run finds, compared with the notes on earlier runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from ifgen.definition.interfaces import Registry
from ifgen.pipeline.freshness import fingerprints
from ifgen.pipeline.freshness.modules import Modules
from ifgen.pipeline.freshness.notes import Notes
from ifgen.pipeline.freshness.state import Found, State
from ifgen.pipeline.values import Made
from ifgen.reading.manifest import Manifest
from ifgen.writing import write


@dataclass(frozen=True, slots=True)
class Unchanged:
    """Results of an earlier run that would not change: packages, each with its manifest, and single modules.

    `done` are the diagnostics to repeat if nothing else is asked for.
    """

    packages: Mapping[str, Manifest] = field(default_factory=dict[str, Manifest])
    modules: Callable[[Registry], Modules | None] = lambda _: None
    done: Made | None = None


def unchanged_since(notes: Notes, state: State) -> Unchanged:
    """What generating would not change, of what was noted."""
    found: dict[str, Manifest] = {}
    asked = {name for name, package in state.packages.items() if package.source is not None}
    pending = list(asked)
    while pending:
        name = pending.pop()
        record = _intact(name, state.packages[name], notes, state.output)
        if record is not None:
            found[name] = record
            along = (notes.needed_by(name) & state.packages.keys()) - asked
            asked |= along
            pending += along
    needed = {name for package in found for name in notes.needed_by(package)} - found.keys()
    is_all = found.keys() == asked
    if is_all and state.root is not None:
        root = replace(state.root, own=asked, inputs=notes.of_run(asked))
        record = _intact(write.ROOT, root, notes, state.output)
        is_all = record is not None
        found |= {write.ROOT: record} if record is not None else {}
    told = notes.told(state.request, asked, state.users) if is_all else None
    done = None if told is None else Made((), found.keys(), needed, told, found)

    def modules(registry: Registry) -> Modules:
        return Modules(notes, state, fingerprints.of_modules(registry, state.digests.generator))

    return Unchanged(found, modules, done)


def _intact(name: str, package: Found, notes: Notes, output: Path) -> Manifest | None:
    """The manifest of a package, if its sources are as noted, and its files as an earlier run left them."""
    note, record = notes.packages.get(name), package.manifest
    if note is None or record is None:
        return None
    is_as_noted = (package.own, package.inputs, record.digest) == (set(note.own), note.inputs, note.manifest)
    is_from_there = record.source == package.source
    return (
        record if is_as_noted and is_from_there and write.is_intact(record, output / name, output) else None
    )

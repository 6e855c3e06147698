"""Compares the state that a run finds with the notes on earlier runs: what is as noted need not be made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from ifgen.definition.interfaces import Registry
from ifgen.pipeline.freshness import fingerprints
from ifgen.pipeline.freshness.modules import Modules
from ifgen.pipeline.freshness.notes import Notes
from ifgen.pipeline.freshness.state import State
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
    """The part of what was noted that generating would not change."""
    asked = {name for name, package in state.packages.items() if package.source is not None}
    as_noted: dict[str, Manifest] = {}
    needed: set[str] = set()
    pending = list(asked)
    while pending:
        name = pending.pop()
        note = notes.packages.get(name)
        record = note.manifest_of(state.packages[name]) if note else None
        if record is not None:
            as_noted[name] = record
            needs = notes.needed_by(name)
            along = (needs & state.packages.keys()) - asked
            needed |= needs
            asked |= along
            pending += along
    if state.root is not None and as_noted.keys() == asked:
        root = replace(state.root, own=asked, inputs=notes.of_run(asked))
        note = notes.packages.get(write.ROOT)
        record = note.manifest_of(root) if note else None
        as_noted |= {write.ROOT: record} if record is not None else {}
    output = state.output
    found = {name: made for name, made in as_noted.items() if write.is_intact(made, output / name, output)}
    is_all = found.keys() == (asked if state.root is None else asked | {write.ROOT})
    told = notes.told(state.request, asked, state.users) if is_all else None
    done = None if told is None else Made((), found.keys(), needed - found.keys(), told, found)

    def modules(registry: Registry) -> Modules:
        return Modules(notes, state, fingerprints.of_modules(registry, state.digests.generator))

    packages = {name: made for name, made in found.items() if name != write.ROOT}
    return Unchanged(packages, modules, done)

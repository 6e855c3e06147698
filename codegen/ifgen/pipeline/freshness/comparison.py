"""What need not be generated: the state that a run finds, compared with the notes on earlier runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from ifgen.definition.interfaces import Registry
from ifgen.pipeline.freshness import fingerprints
from ifgen.pipeline.freshness.modules import Modules
from ifgen.pipeline.freshness.notes import Note, Notes
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
    asked = {name for name, package in state.packages.items() if package.source is not None}
    as_noted: dict[str, Manifest] = {}
    needed: set[str] = set()
    pending = list(asked)
    while pending:
        name = pending.pop()
        record = _as_noted(state.packages[name], notes.packages.get(name))
        if record is not None:
            as_noted[name] = record
            needs = notes.needed_by(name)
            along = (needs & state.packages.keys()) - asked
            needed |= needs
            asked |= along
            pending += along
    if state.root is not None and as_noted.keys() == asked:
        root = replace(state.root, own=asked, inputs=notes.of_run(asked))
        record = _as_noted(root, notes.packages.get(write.ROOT))
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


def _as_noted(package: Found, note: Note | None) -> Manifest | None:
    """The manifest of a package, if that and everything that the package is generated from are as noted."""
    made = package.manifest
    if note is None or made is None or made.source != package.source:
        return None
    found = (package.own, package.inputs, made.digest)
    return made if found == (set(note.own), note.inputs, note.manifest) else None

"""Tells what needs no work, by what it was generated from; nothing is parsed for it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ifgen import resources
from ifgen.definition.interfaces import Interface, Registry
from ifgen.diagnostics import Diagnostic
from ifgen.pipeline import earlier, fingerprints, remembered
from ifgen.pipeline.digests import Digests, as_read
from ifgen.pipeline.notes import Modules, Note, Notes, digest_of_manifest
from ifgen.pipeline.values import Inputs, Made
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.reading.search_path import WithDeps
from ifgen.writing import interruption, write

if TYPE_CHECKING:
    from ifgen.pipeline.job import Job, Target

Done = TypeVar("Done")


@dataclass(frozen=True, slots=True)
class Unchanged:
    """Results of an earlier run that would not change: packages, each with its manifest, and single modules.

    `done` are the diagnostics to repeat if nothing else is asked for.
    """

    packages: Mapping[str, Manifest] = field(default_factory=dict[str, Manifest])
    modules: Callable[[Registry], Modules | None] = lambda _: None
    done: Made | None = None


def unless_fresh(
    inputs: Inputs, make: Callable[[Inputs, Unchanged], Made], finish: Callable[[Inputs, Made], Done]
) -> Done:
    """Make what an earlier run did not leave as it has to be, finish that, and remember it for the next run.

    Nothing is made if nothing has changed. Once it is being finished, an interruption waits.
    """
    freshness = _Freshness(inputs)
    unchanged = freshness.unchanged()
    made = unchanged.done or make(inputs, unchanged)
    with interruption.held("all files had been written"):
        done = finish(inputs, made)
        if made.job is not None:
            freshness.remember(made.job, made.told)
    return done


class _Freshness:
    """The sources of an output folder, and its changes since.

    Made before anything is parsed: what users save from then on is not taken for what was read.
    """

    def __init__(self, inputs: Inputs) -> None:
        self._packages = inputs.packages
        self._search = inputs.search
        self._output = inputs.output
        self._with_deps: WithDeps = inputs.with_deps
        self._condition = inputs.condition.key if inputs.condition else ""
        outputs_of_run = (output for output in inputs.custom.outputs if output.per == "run")
        self._once_in_a_run = any(outputs_of_run) and not inputs.custom.partial
        generator = fingerprints.of_generator(resources.templates())
        self._generator = generator + fingerprints.of_customization(inputs.custom)
        self._descriptions = {
            package.name: fingerprints.of_own_description(package, self._search) for package in self._packages
        }
        self._ours: frozenset[str] = frozenset()  # only pip needs to know what is generated beside a package
        if inputs.custom.distributions is not None:
            self._ours = frozenset({*self._descriptions, *earlier.packages_in(self._output)})
        self._users = fingerprints.of_files(self._modules_of_users())
        self._notes = Notes(self._output)
        self._digests = Digests(self._search)

    def unchanged(self) -> Unchanged:
        """The packages that generating would not change."""
        found: dict[str, Manifest] = {}
        asked: dict[str, PackageFiles | None] = {package.name: package for package in self._packages}
        pending = list(self._packages)
        while pending:
            package = pending.pop()
            record = self._intact(package)
            if record is None:
                continue
            found[package.name] = record
            for name in self._notes.packages[package.name].packages():
                if name not in asked and self._search.comes_along(name, self._with_deps):
                    asked[name] = other = self._search.package(name)
                    pending += [other] if other else []
        is_all = found.keys() == asked.keys()
        if is_all and self._once_in_a_run:
            record = self._intact_root(asked)
            is_all = record is not None
            found |= {write.ROOT: record} if record is not None else {}
        told = self._told(asked) if is_all else None
        done = None if told is None else Made((), found.keys(), self._needed(found), told, found)
        return Unchanged(found, self._modules, done)

    def remember(self, job: Job, told: Sequence[Diagnostic]) -> None:
        """Note that the packages of a run have been generated just now from what was read for it."""
        notes = dict(self._notes.packages)
        names = [target.name for target in job.targets]
        ours = self._ours.union(names) if self._ours else self._ours
        # The digests of what was parsed count, not the current state of the files.
        digests = Digests(self._search, as_read(job, self._packages))
        modules = fingerprints.of_modules(job.registry, self._generator)
        for target in job.targets:
            note = _note(target, job.registries, modules)
            inputs = self._inputs(target.name, note, digests, ours)
            notes[target.name] = replace(note, inputs=inputs, manifest=self._manifest(target.name))
        if self._once_in_a_run:
            notes[write.ROOT] = self._note_of_run(names, notes)
        # The users' modules as they were when they were compared, and those that were written since.
        users = fingerprints.of_files(self._modules_of_users()) | self._users
        run = [_inputs_of_run(names, notes, users), remembered.as_document(told)]
        self._notes.replace(notes, self._key_of_run(), run)

    def _modules(self, registry: Registry) -> Modules:
        """The modules that can stay in packages of which others have to be rendered."""
        return Modules(self._output, self._notes, fingerprints.of_modules(registry, self._generator))

    def _needed(self, found: Mapping[str, Manifest]) -> set[str]:
        """The packages that others need, without those."""
        notes = (self._notes.packages[name] for name in found if name != write.ROOT)
        return {name for note in notes for name in note.packages()} - set(found)

    def _told(self, names: Iterable[str]) -> tuple[Diagnostic, ...] | None:
        """The diagnostics of a run with the same request; None if there was none, or something is new."""
        with suppress(KeyError, TypeError, ValueError, IndexError, AttributeError):
            inputs, document = self._notes.runs[self._key_of_run()]
            if inputs == _inputs_of_run(names, self._notes.packages, self._users):
                return remembered.from_document(document)
        return None

    def _key_of_run(self) -> str:
        """The request of a run and its working folder, because messages name paths relative to that.

        A condition is part of the request: what did not meet another one may not meet this one.
        """
        names = [package.name for package in self._packages]
        text = repr((names, self._with_deps, str(Path().absolute()), self._condition))
        return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:32]

    def _modules_of_users(self) -> Iterator[Path]:
        """The users' modules of nodes, which are compared with the descriptions."""
        for package in self._packages:
            if package.nodes:
                yield from sorted((self._output / package.name / package.name).rglob("[!_]*.py"))

    def _intact(self, package: PackageFiles) -> Manifest | None:
        note = self._notes.packages.get(package.name)
        own = _own(package)
        has_twins = len(own) < len(package.files) + len(package.nodes)  # an .idl file beside a .msg file
        if note is None or own != set(note.own) or has_twins or self._manifest(package.name) != note.manifest:
            return None
        if self._inputs(package.name, note, self._digests, self._ours) != note.inputs:
            return None
        record = write.intact(package.name, self._output)
        asked_for = package.name in self._descriptions
        source = earlier.source_of(package, self._output) if asked_for else None
        return record if record is not None and record.source == source else None

    def _intact_root(self, packages: Iterable[str]) -> Manifest | None:
        """The same of what is made once in a run that is about these packages."""
        is_noted = self._notes.packages.get(write.ROOT) == self._note_of_run(packages, self._notes.packages)
        return write.intact(write.ROOT, self._output) if is_noted else None

    def _note_of_run(self, packages: Iterable[str], notes: Mapping[str, Note]) -> Note:
        """The digest of the outputs per run, from everything that its packages are generated from."""
        names = tuple(sorted(packages))
        inputs = hashlib.sha256("\n".join(notes[name].inputs for name in names).encode()).hexdigest()
        return Note(names, inputs=inputs, manifest=self._manifest(write.ROOT))

    def _inputs(self, package: str, note: Note, digests: Digests, ours: Iterable[str]) -> str:
        """The digest of everything that a package's generated files depend on."""
        hasher = hashlib.sha256(self._generator + self._descriptions.get(package, b""))
        hasher.update(repr(sorted(ours)).encode())
        types = ((name, digests.of_type(name)) for name in (*note.own, *note.needed))
        documents = ((path, digests.of_path(path)) for path in note.documents)
        for name, digest in (*types, *documents):
            hasher.update(name.encode(errors="surrogateescape"))
            hasher.update(digest)
        return hasher.hexdigest()

    def _manifest(self, package: str) -> str:
        return digest_of_manifest(self._output / package)


def _note(target: Target, registries: Sequence[Registry], modules: Mapping[str, str]) -> Note:
    """The sources of a package, without their digests."""
    own: list[str] = []
    uses: set[str] = set()
    of_modules: dict[str, str] = {}
    documents: tuple[str, ...] = ()
    if target.interfaces is not None:
        own += (interface.type_name for interface in target.interfaces.interfaces)
        of_modules = {name: modules[name] for name in own}
        uses.add(target.name)
    if target.nodes is not None:
        own += target.described
        uses.update(e.type_name.partition("/")[0] for node in target.nodes.nodes for e in node.endpoints)
        documents = tuple(str(path.resolve()) for path in target.documents)
    return Note(tuple(own), _needed(target.name, uses, registries), documents, of_modules)


def _inputs_of_run(names: Iterable[str], notes: Mapping[str, Note], users: Mapping[str, bytes]) -> str:
    """The digest of everything that there is something to say about."""
    hasher = hashlib.sha256("\n".join(notes[name].inputs for name in sorted(names)).encode())
    for path, digest in sorted(users.items()):
        hasher.update(path.encode(errors="surrogateescape") + digest)
    return hasher.hexdigest()


def _own(package: PackageFiles) -> set[str]:
    own = {f"{package.name}/{file.folder}/{file.name}" for file in package.files}
    return own | {f"{package.name}/{NODE_FOLDER}/{node.name}" for node in package.nodes}


def _needed(package: str, uses: Iterable[str], registries: Sequence[Registry]) -> tuple[str, ...]:
    """The interfaces in the packages that a package uses, and that their fields need, and so on."""
    found = set(uses)
    pending = list(found)
    while pending:
        interfaces = _interfaces(pending.pop(), registries)
        types = (name for interface in interfaces for name in fingerprints.needed_types(interface))
        more = {name.partition("/")[0] for name in types} - found
        found |= more
        pending += more
    others = (interface for name in sorted(found - {package}) for interface in _interfaces(name, registries))
    return tuple(dict.fromkeys(interface.type_name for interface in others))


def _interfaces(package: str, registries: Sequence[Registry]) -> Iterator[Interface]:
    for registry in registries:
        if package in registry.packages:
            yield from registry.packages[package].interfaces

"""Tells what needs no work, by what it was generated from; nothing is parsed for it."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization
from ifgen.definition.interfaces import Interface, Registry
from ifgen.diagnostics import Diagnostic
from ifgen.pipeline import earlier, fingerprints, remembered
from ifgen.pipeline.notes import Modules, Note, Notes, digest_of_manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles, SearchPath, WithDeps
from ifgen.reading.text_files import read_limited
from ifgen.writing import write

if TYPE_CHECKING:
    from ifgen.pipeline.job import Job, Target


class Freshness:
    """What was generated into an output folder from what, and what has become of it since.

    Made before anything is read: what users save from then on is not taken for what was read.
    """

    def __init__(
        self,
        output: Path,
        packages: Sequence[PackageFiles],
        search: SearchPath,
        custom: Customization,
        templates: Path,
    ) -> None:
        self._output = output
        self._packages = packages
        self._search = search
        self._generator = fingerprints.of_generator(templates) + fingerprints.of_customization(custom)
        self._once_in_a_run = any(o.per == "run" for o in custom.outputs) and not custom.partial
        self._digests: dict[str, bytes] = {}
        self._modules: dict[str, str] = {}
        self._descriptions = {
            package.name: fingerprints.of_own_description(package, search) for package in packages
        }
        self._ours: set[str] = set()  # only pip needs to know what is generated beside a package
        if custom.distributions is not None:
            self._ours = {*self._descriptions, *earlier.packages_in(output)}
        self._users = fingerprints.of_files(self._modules_of_users())
        self._notes = Notes(output)

    def fresh(self, with_deps: WithDeps) -> tuple[dict[str, Manifest], tuple[Diagnostic, ...] | None]:
        """The packages that are as generating would leave them.

        If those are all that is asked for, also what there is to say about them, as it was said before.
        """
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
                if name not in asked and self._search.comes_along(name, with_deps):
                    asked[name] = other = self._search.find(name)
                    pending += [other] if other else []
        if found.keys() != asked.keys():
            return found, None
        if self._once_in_a_run:
            record = write.intact(write.ROOT, self._output)
            noted, notes = self._notes.packages.get(write.ROOT), self._notes.packages
            if record is None or noted != self._note_of_run(asked, notes):
                return found, None
            found[write.ROOT] = record
        return found, self._told(asked, with_deps)

    def needed(self, fresh: Collection[str]) -> set[str]:
        """The packages that fresh ones need, without those."""
        notes = (self._notes.packages[name] for name in fresh if name != write.ROOT)
        return {name for note in notes for name in note.packages()} - set(fresh)

    def modules(self, job: Job) -> Modules:
        """What can stay as it is in packages of which something is to be rendered."""
        self._modules = fingerprints.of_modules(job.registry, self._generator)
        return Modules(self._output, self._notes, self._modules)

    def remember(self, job: Job, with_deps: WithDeps, told: Sequence[Diagnostic]) -> None:
        """Note that the packages of a run have been generated just now from what was read for it."""
        # What was parsed counts, not what has become of the files since.
        registries = [job.registry, *([job.nodes.registry] if job.nodes else [])]
        parsed = (interface for registry in registries for interface in registry)
        self._digests = {i.type_name: fingerprints.of_source(i.source) for i in parsed if i.source}
        xmls = (package.declared.source for package in self._packages if package.declared)
        self._digests.update((str(xml.path.resolve()), fingerprints.of_source(xml)) for xml in xmls)
        notes = dict(self._notes.packages)
        names = [target.name for target in job.targets]
        self._ours |= set(names) if self._ours else set()
        notes.update((target.name, self._note(target, registries)) for target in job.targets)
        if self._once_in_a_run:
            notes[write.ROOT] = self._note_of_run(names, notes)
        run = [self._inputs_of_run(names, notes, self._users_now()), remembered.as_document(told)]
        self._notes.replace(notes, self._key_of_run(with_deps), run)

    def _told(self, names: Iterable[str], with_deps: WithDeps) -> tuple[Diagnostic, ...] | None:
        """What a run that asked for the same said; None if there was none, or something is new."""
        with suppress(KeyError, TypeError, ValueError, IndexError, AttributeError):
            inputs, document = self._notes.runs[self._key_of_run(with_deps)]
            if inputs == self._inputs_of_run(names, self._notes.packages, self._users):
                return remembered.from_document(document)
        return None

    def _key_of_run(self, with_deps: WithDeps) -> str:
        """What a run was asked for, and from where: messages name paths as seen from there."""
        names = [package.name for package in self._packages]
        text = repr((names, with_deps, str(Path().absolute())))
        return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:32]

    def _inputs_of_run(
        self, names: Iterable[str], notes: Mapping[str, Note], users: Mapping[str, bytes]
    ) -> str:
        """The digest of everything that there is something to say about."""
        hasher = hashlib.sha256("\n".join(notes[name].inputs for name in sorted(names)).encode())
        for path, digest in sorted(users.items()):
            hasher.update(path.encode(errors="surrogateescape") + digest)
        return hasher.hexdigest()

    def _modules_of_users(self) -> Iterator[Path]:
        """The users' modules of nodes, which are compared with the descriptions."""
        for package in self._packages:
            if package.nodes:
                yield from sorted((self._output / package.name / package.name).rglob("[!_]*.py"))

    def _users_now(self) -> Mapping[str, bytes]:
        """As they were when they were compared, and those that were written since."""
        return fingerprints.of_files(self._modules_of_users()) | self._users

    def _note(self, target: Target, registries: Sequence[Registry]) -> Note:
        own: list[str] = []
        uses: set[str] = set()
        documents: list[str] = []
        modules: dict[str, str] = {}
        if target.interfaces is not None:
            own += (interface.type_name for interface in target.interfaces.interfaces)
            modules = {name: self._modules[name] for name in own}
            uses.add(target.name)
        if target.nodes is not None:
            own += target.described
            uses.update(e.type_name.partition("/")[0] for node in target.nodes.nodes for e in node.endpoints)
            documents += (str(path.resolve()) for path in target.documents)
            sources = target.nodes.sources
            self._digests.update((str(s.path.resolve()), fingerprints.of_source(s)) for s in sources)
        needed = _needed(target.name, uses, registries)
        inputs = self._inputs(target.name, (*own, *needed), documents)
        return Note(tuple(own), needed, tuple(documents), modules, inputs, self._manifest(target.name))

    def _intact(self, package: PackageFiles) -> Manifest | None:
        note = self._notes.packages.get(package.name)
        own = _own(package)
        has_twins = len(own) < len(package.files) + len(package.nodes)  # an .idl file beside a .msg file
        if note is None or own != set(note.own) or has_twins or self._manifest(package.name) != note.manifest:
            return None
        if self._inputs(package.name, (*note.own, *note.needed), note.documents) != note.inputs:
            return None
        record = write.intact(package.name, self._output)
        asked_for = package.name in self._descriptions
        source = earlier.source_of(package, self._output) if asked_for else None
        return record if record is not None and record.source == source else None

    def _note_of_run(self, packages: Iterable[str], notes: Mapping[str, Note]) -> Note:
        """Of what is made once in a run, from all that its packages are generated from."""
        names = tuple(sorted(packages))
        inputs = hashlib.sha256("\n".join(notes[name].inputs for name in names).encode()).hexdigest()
        return Note(names, inputs=inputs, manifest=self._manifest(write.ROOT))

    def _inputs(self, package: str, types: Iterable[str], documents: Sequence[str]) -> str:
        """The digest of everything that a package's generated files depend on."""
        hasher = hashlib.sha256(self._generator + self._descriptions.get(package, b""))
        hasher.update(repr(sorted(self._ours)).encode())
        for name in (*types, *documents):
            hasher.update(name.encode(errors="surrogateescape"))
            hasher.update(self._digest(name, name in documents))
        return hasher.hexdigest()

    def _digest(self, name: str, is_path: bool) -> bytes:
        """Of the file that a type name stands for today, or at a path; of nothing if there is none."""
        if name not in self._digests:
            path = Path(name) if is_path else self._path_of(name)
            try:
                self._digests[name] = fingerprints.of_text(read_limited(path)) if path else b""
            except OSError:
                self._digests[name] = b""
        return self._digests[name]

    def _path_of(self, type_name: str) -> Path | None:
        package_name, folder, name = type_name.split("/")
        package = self._search.find(package_name)
        file = package.find(folder, name) if package else None
        return file.path if file else None

    def _manifest(self, package: str) -> str:
        return digest_of_manifest(self._output / package)


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

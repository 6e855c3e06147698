"""Tells which generated packages need no work, by what they were generated from; nothing is parsed for it.

That is noted in the user's cache folder and not in the output, for the note names ifgen down to its code:
committed manifests would change for no reason. Losing it costs time only.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen import interface_list, manifest, package_xml, ros_distro, transaction, write
from ifgen.customization import Customization
from ifgen.definition.interfaces import Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.manifest import Manifest
from ifgen.read import NODE_FOLDER, PackageFiles, SearchPath, WithDeps
from ifgen.text_files import read_limited

if TYPE_CHECKING:
    from ifgen.job import Job, Target


@dataclass(frozen=True, slots=True)
class _Note:
    """What a package was generated from.

    `own` are its interfaces and nodes and `needed` the interfaces that those need, as `pkg/msg/Name`;
    `documents` are the paths of other files that were read.
    """

    own: tuple[str, ...]
    needed: tuple[str, ...]
    documents: tuple[str, ...]
    inputs: str
    manifest: str

    def packages(self) -> set[str]:
        """The packages that it needs."""
        return {type_name.partition("/")[0] for type_name in self.needed}


class Freshness:
    """What was generated into an output folder from what, and what has become of it since."""

    def __init__(self, output: Path, search: SearchPath, custom: Customization, templates: Path) -> None:
        import platformdirs

        name = hashlib.sha256(str(output.resolve()).encode(errors="surrogateescape")).hexdigest()[:32]
        self._path = platformdirs.user_cache_path("ifgen") / "generated" / f"{name}.json"
        self._output = output
        self._search = search
        self._generator = _digest_of_generator(templates) + _digest_of_customization(custom)
        self._once_in_a_run = any(o.per == "run" for o in custom.outputs) and not custom.partial
        self._digests: dict[str, bytes] = {}
        self._notes: dict[str, _Note] = {}
        with suppress(OSError, ValueError, TypeError, AttributeError):
            notes = json.loads(self._path.read_text(encoding="utf-8"))
            self._notes = {
                name: _Note(tuple(own), tuple(needed), tuple(documents), *rest)
                for name, (own, needed, documents, *rest) in notes.items()
            }

    def fresh(
        self, packages: Sequence[PackageFiles], with_deps: WithDeps
    ) -> tuple[dict[str, Manifest], bool]:
        """The packages that are as generating would leave them; whether those are all that is asked for."""
        found: dict[str, Manifest] = {}
        asked: dict[str, PackageFiles | None] = {package.name: package for package in packages}
        pending = list(packages)
        while pending:
            package = pending.pop()
            record = self._intact(package)
            if record is None:
                continue
            found[package.name] = record
            for name in self._notes[package.name].packages():
                if name not in asked and self._search.comes_along(name, with_deps):
                    asked[name] = other = self._search.find(name)
                    pending += [other] if other else []
        fresh = found.keys() == asked.keys()
        if fresh and self._once_in_a_run:
            record = write.intact(write.ROOT, self._output)
            fresh = record is not None and self._notes.get(write.ROOT) == self._note_of_run(asked)
            found |= {write.ROOT: record} if record is not None and fresh else {}
        return found, fresh

    def needed(self, fresh: Collection[str]) -> set[str]:
        """The packages that fresh ones need, without those."""
        notes = (self._notes[name] for name in fresh if name != write.ROOT)
        return {name for note in notes for name in note.packages()} - set(fresh)

    def remember(self, job: Job) -> None:
        """Note that the packages of a run have been generated just now from what was read for it."""
        # What was parsed counts, not what has become of the files since.
        registries = [job.registry, *([job.nodes.registry] if job.nodes else [])]
        parsed = (interface for registry in registries for interface in registry)
        self._digests = {i.type_name: _digest(i.source.text.encode()) for i in parsed if i.source}
        notes = dict(self._notes)
        roots = {package.name: package.root for package in job.packages}
        for target in job.targets:
            notes[target.name] = self._note(target, roots.get(target.name), registries)
        self._notes, before = notes, self._notes
        if self._once_in_a_run:
            notes[write.ROOT] = self._note_of_run(target.name for target in job.targets)
        if notes == before:
            return
        text = json.dumps({name: astuple(note) for name, note in notes.items()})
        with suppress(OSError):
            self._path.parent.mkdir(parents=True, exist_ok=True)
            transaction.apply([(self._path, text.encode())], self._path.parent)

    def _note(self, target: Target, root: Path | None, registries: Sequence[Registry]) -> _Note:
        own: list[str] = []
        uses: set[str] = set()
        documents: list[str] = []
        if target.interfaces is not None:
            own += (interface.type_name for interface in target.interfaces.interfaces)
            uses.add(target.name)
        if target.nodes is not None:
            own += target.described
            uses.update(e.type_name.partition("/")[0] for node in target.nodes.nodes for e in node.endpoints)
            documents += map(str, target.documents(self._output))
            self._digests.update((str(s.path), _digest(s.text.encode())) for s in target.nodes.sources)
        if root is not None:  # what these say decides what there is to warn of
            documents += (str(root / name) for name in (package_xml.NAME, interface_list.FILE))
        needed = _needed(target.name, uses, registries)
        inputs = self._inputs((*own, *needed), documents)
        return _Note(tuple(own), needed, tuple(documents), inputs, self._manifest(target.name))

    def _intact(self, package: PackageFiles) -> Manifest | None:
        note = self._notes.get(package.name)
        own = {f"{package.name}/{file.folder}/{file.name}" for file in package.files}
        has_twins = len(own) < len(package.files)  # an .idl file beside a .msg file
        own |= {f"{package.name}/{NODE_FOLDER}/{node.name}" for node in package.nodes}
        if note is None or own != set(note.own) or has_twins or self._manifest(package.name) != note.manifest:
            return None
        if self._inputs((*note.own, *note.needed), note.documents) != note.inputs:
            return None
        return write.intact(package.name, self._output)

    def _note_of_run(self, packages: Iterable[str]) -> _Note:
        """Of what is made once in a run, from all that its packages are generated from."""
        names = tuple(sorted(packages))
        inputs = hashlib.sha256("\n".join(self._notes[name].inputs for name in names).encode()).hexdigest()
        return _Note(names, (), (), inputs, self._manifest(write.ROOT))

    def _inputs(self, types: Iterable[str], documents: Sequence[str]) -> str:
        """The digest of everything that a package's generated files depend on."""
        hasher = hashlib.sha256(self._generator)
        for name in (*types, *documents):
            hasher.update(name.encode(errors="surrogateescape"))
            hasher.update(self._digest(name, name in documents))
        return hasher.hexdigest()

    def _digest(self, name: str, is_path: bool) -> bytes:
        """Of the file that a type name stands for today, or at a path; of nothing if there is none."""
        if name not in self._digests:
            path = Path(name) if is_path else self._path_of(name)
            try:
                self._digests[name] = _digest(read_limited(path)) if path else b""
            except OSError:
                self._digests[name] = b""
        return self._digests[name]

    def _path_of(self, type_name: str) -> Path | None:
        package_name, folder, name = type_name.split("/")
        package = self._search.find(package_name)
        file = package.find(folder, name) if package else None
        return file.path if file else None

    def _manifest(self, package: str) -> str:
        """The digest of a package's manifest: another ifgen may have generated there since."""
        try:
            return manifest.digest((self._output / package / manifest.NAME).read_bytes())
        except OSError:
            return ""


def _digest(data: bytes) -> bytes:
    """Of a file, whose line ends do not count, as they do not for the parser."""
    return hashlib.sha256(data.replace(b"\r\n", b"\n")).digest()


def _needed(package: str, uses: Iterable[str], registries: Sequence[Registry]) -> tuple[str, ...]:
    """The interfaces in the packages that a package uses, and that their fields need, and so on."""
    found = set(uses)
    pending = list(found)
    while pending:
        for interface in _interfaces(pending.pop(), registries):
            for message in (interface,) if isinstance(interface, Message) else interface.messages:
                for _, type_ in references(message):
                    if type_.package not in found:
                        found.add(type_.package)
                        pending.append(type_.package)
    others = (interface for name in sorted(found - {package}) for interface in _interfaces(name, registries))
    return tuple(dict.fromkeys(interface.type_name for interface in others))


def _interfaces(package: str, registries: Sequence[Registry]) -> Iterator[Interface]:
    for registry in registries:
        if package in registry.packages:
            yield from registry.packages[package].interfaces


def _digest_of_customization(custom: Customization) -> bytes:
    """Of everything that a user adds to generating, empty if that is nothing."""
    is_old = ros_distro.is_old(custom.ros_distro)
    if custom == Customization(partial=custom.partial, ros_distro=custom.ros_distro) and not is_old:
        return b""
    said = (custom.outputs, custom.tests, custom.distributions, is_old)
    hasher = hashlib.sha256(repr(said).encode(errors="surrogateescape"))
    paths = [path for folder in custom.folders for path in sorted(folder.rglob("*"))]
    for path in (*paths, *([custom.filters] if custom.filters else ())):
        if path.is_file():
            hasher.update(f"{path}\0".encode(errors="surrogateescape") + _digest(path.read_bytes()))
    return hasher.digest()


def _digest_of_generator(templates: Path) -> bytes:
    """Of ifgen's own code and templates; a version number would miss changes in a checkout."""
    hasher = hashlib.sha256()
    here = Path(__file__).parent
    rooms = (here / "idl", here / "definition", here / "nodl", here / "generator_py", templates)
    for path in (*sorted(here.glob("*.py")), *(file for room in rooms for file in sorted(room.rglob("*.*")))):
        if path.suffix != ".pyc" and path.is_file():
            hasher.update(f"{path.name}\0".encode(errors="surrogateescape") + path.read_bytes())
    return hasher.digest()

"""Digests of what generated files and warnings come from: where they are the same, so is what comes out."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable, Iterator, Mapping
from copy import copy
from dataclasses import replace
from itertools import chain
from pathlib import Path

from ifgen import resources
from ifgen.config.customization import Customization
from ifgen.config.suppressions import is_old
from ifgen.definition import dependencies, derive
from ifgen.definition.interfaces import Action, Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.diagnostics import Source
from ifgen.pipeline.cache.record import PackageRecord, sources_of
from ifgen.pipeline.values import Request, ResolvedInput, Target
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.reading.search_path import SearchPath
from ifgen.reading.storage import MAX_GENERATED, read_limited
from ifgen.writing.write import ROOT


class Fingerprints:
    """Digests of what a run reads; each file is read once.

    What is the same for all packages, what packages say about themselves, and the users' modules are read at
    once.
    """

    def __init__(self, request: Request) -> None:
        self.request = _of_request(request)
        self._search = request.search
        self._output = request.output
        self._packages = {package.name: _of_package(package, self._search) for package in request.packages}
        self._users = _of_users_modules(request.packages, self._output)
        self._generator = of_generator(resources.templates()) + _of_customization(request.custom)
        self._targets = _of_targets(request.custom)
        self._ours: set[str] = set()  # only pip needs to know what is generated beside a package
        if request.custom.distributions is not None:
            self._ours = self._packages.keys() | request.previous.keys() - {ROOT}
        self._files: dict[str, bytes] = {}  # by the names of their types, or by their paths
        self._modules: dict[str, str] = {}

    def as_read(self, resolved: ResolvedInput) -> Fingerprints:
        """The digests of what was parsed, whatever has become of the files since."""
        parsed = (interface for registry in resolved.registries for interface in registry)
        xmls = (package.declared.source for package in resolved.packages if package.declared)
        documents = (source for target in resolved.targets if target.nodes for source in target.nodes.sources)
        same = copy(self)
        same._files = {i.type_name: _of_source(i.source) for i in parsed if i.source}
        same._files |= {str(source.path.resolve()): _of_source(source) for source in (*xmls, *documents)}
        # The users' modules as they were when they were compared, and those that were written since.
        same._users = _of_users_modules(resolved.packages, self._output) | self._users
        same._ours = (
            self._ours.union(target.name for target in resolved.targets) if self._ours else self._ours
        )
        return same

    def match(self, name: str, recorded: PackageRecord) -> bool:
        """Whether a package has the recorded interfaces and nodes, and is generated from the same sources."""
        package = self._search.package(name)
        if package is None:
            return False
        own = [f"{name}/{file.folder}/{file.name}" for file in package.files]
        own += (f"{name}/{NODE_FOLDER}/{node.name}" for node in package.nodes)
        # One may be there twice: an .idl file beside a .msg file.
        return sorted(own) == sorted(recorded.own) and self._of_sources(name, recorded) == recorded.inputs

    def records(self, resolved: ResolvedInput) -> dict[str, PackageRecord]:
        """The sources of the packages of a run."""
        needs, modules = Needs(resolved.registries), self.of_modules(resolved.registry)
        return {target.name: self._record(target, needs, modules) for target in resolved.targets}

    def of_run(self, records: Iterable[PackageRecord], others: Iterable[Manifest]) -> str:
        """The digest of the sources of packages, of the users' modules, and of what is made once in a run."""
        hasher = hashlib.sha256("\n".join(recorded.inputs for recorded in records).encode())
        for path, digest in sorted(self._users.items()):
            hasher.update(path.encode(errors="surrogateescape") + digest)
        for found in others:
            hasher.update(found.digest.encode())
        hasher.update(self._targets)
        return hasher.hexdigest()

    def of_modules(self, registry: Registry) -> Mapping[str, str]:
        """By type name, of everything that the module of an interface depends on.

        It covers the text of the interface, of all interfaces that its fields need, and the generator.
        """
        if not self._modules:
            needs = Needs([registry])
            texts = {
                i.type_name: _named(i.type_name, _of_source(i.source) if i.source else b"") for i in registry
            }
            for name in texts:
                hasher = hashlib.sha256(self._generator + name.encode())
                for needed in sorted(needs.by([name])):
                    hasher.update(texts[needed])
                self._modules[name] = hasher.hexdigest()[:32]
        return self._modules

    def _record(self, target: Target, needs: Needs, modules: Mapping[str, str]) -> PackageRecord:
        interfaces = [i.type_name for i in target.interfaces.interfaces] if target.interfaces else []
        endpoints = (
            [e.type_name for node in target.nodes.nodes for e in node.endpoints] if target.nodes else []
        )
        own = [*interfaces, *target.described]
        needed = sorted(needs.by([*interfaces, *endpoints]).difference(own))
        documents = [str(path.resolve()) for path in target.documents]
        sources = PackageRecord(own, needed, documents, {name: modules[name] for name in interfaces})
        return replace(sources, inputs=self._of_sources(target.name, sources))

    def _of_sources(self, name: str, sources: PackageRecord) -> str:
        """The digest of everything that the files of a package depend on."""
        hasher = hashlib.sha256(self._generator + self._packages.get(name, b""))
        hasher.update(repr(sorted(self._ours)).encode())
        types = ((type_name, self._of_type(type_name)) for type_name in (*sources.own, *sources.needed))
        documents = ((path, self._of_document(path)) for path in sources.documents)
        for source, digest in (*types, *documents):
            hasher.update(source.encode(errors="surrogateescape"))
            hasher.update(digest)
        return hasher.hexdigest()

    def _of_type(self, name: str) -> bytes:
        """The digest of the file that a type name stands for today; of nothing if there is none."""
        if name not in self._files:
            package_name, folder, file_name = name.split("/")
            package = self._search.package(package_name)
            file = package.interface(folder, file_name) if package else None
            self._files[name] = of_file(file.path) if file else b""
        return self._files[name]

    def _of_document(self, path: str) -> bytes:
        if path not in self._files:
            self._files[path] = of_file(Path(path))
        return self._files[path]


class Needs:
    """The interfaces that interfaces need, also through others."""

    def __init__(self, registries: Iterable[Registry]) -> None:
        self._owners = {
            name: interface
            for registry in registries
            for interface in registry
            for name in (interface.type_name, *(part.type_name for part in _parts(interface)))
        }
        self._direct: dict[str, tuple[str, ...]] = {}

    def by(self, type_names: Iterable[str]) -> set[str]:
        """The names of these interfaces, and of all that they need."""
        found: set[str] = set()
        pending = list(type_names)
        while pending:
            interface = self._owners[pending.pop()]
            name = interface.type_name
            if name not in found:
                found.add(name)
                if name not in self._direct:
                    self._direct[name] = tuple(_needed_types(interface))
                pending += self._direct[name]
        return found


def of_generator(templates: Path) -> bytes:
    """The digest of ifgen's code (a version would miss changes in a checkout), templates, and of Python.

    Names that Python's own modules have decide how imports are sorted, for example.
    """
    hasher = hashlib.sha256(sys.version.encode())
    # A wheel has these in the package too; what matters of them counts by itself. Commands decide nothing.
    places = (resources.bundled_interfaces(), resources.bundled_nodes(), resources.examples())
    others = [place for place in (*places, resources.PACKAGE / "cli") if resources.PACKAGE in place.parents]
    for folder, path in chain(_files_below(resources.PACKAGE), _files_below(templates)):
        if not any(path.is_relative_to(other) for other in others):
            hasher.update(_named(str(path.relative_to(folder)), path.read_bytes()))
    return hasher.digest()


def of_file(path: Path) -> bytes:
    """The digest of a file; of nothing if it cannot be read."""
    try:
        return _of_text(read_limited(path))
    except OSError:
        return b""


def _of_request(request: Request) -> str:
    """The digest of what is asked for, and of the working folder: messages name paths relative to that.

    A condition is part of the request: what did not meet another one may not meet this one.
    """
    names = [package.name for package in request.packages]
    condition = request.condition.key if request.condition else ""
    text = repr((names, request.with_deps, str(Path().absolute()), condition))
    return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:32]


def _of_users_modules(packages: Iterable[PackageFiles], output: Path) -> dict[str, bytes]:
    """The digests of the users' modules of nodes, which are compared with the descriptions, by path."""
    folders = (output / package.name / package.name for package in packages if package.nodes)
    return {str(path): of_file(path) for folder in folders for path in folder.rglob("[!_]*.py")}


def _of_text(data: bytes) -> bytes:
    """The digest of a text. Line ends do not count, as they do not for the parser."""
    return hashlib.sha256(data.replace(b"\r\n", b"\n")).digest()


def _of_source(source: Source) -> bytes:
    return _of_text(source.text.encode(errors="surrogateescape"))


def _of_customization(custom: Customization) -> bytes:
    """The digest of all the user's additions, empty if there are none."""
    is_for_old = is_old(custom.ros_distro)
    of_python = replace(custom, targets=(), python=True)
    if of_python == Customization(partial=custom.partial, ros_distro=custom.ros_distro) and not is_for_old:
        return b""
    values = (
        custom.outputs,
        custom.tests,
        custom.distributions,
        sorted(custom.requirements.items()),
        is_for_old,
    )
    hasher = hashlib.sha256(repr(values).encode(errors="surrogateescape"))
    paths = [path for folder in custom.folders for _, path in _files_below(folder)]
    for path in (*paths, *([custom.filters] if custom.filters else ())):
        if path.is_file():
            hasher.update(_named(str(path), _of_text(read_limited(path, MAX_GENERATED))))
    return hasher.digest()


def _of_targets(custom: Customization) -> bytes:
    """The digest of the generators of a run, of their options, and of their code."""
    if not custom.targets or custom.partial:
        return b"" if custom.python else b"no Python"
    from ifgen.pipeline.generators.find import sources  # of use to few

    hasher = hashlib.sha256(repr((custom.python, custom.targets)).encode(errors="surrogateescape"))
    for target in custom.targets:
        hasher.update(str(target.base).encode(errors="surrogateescape"))
        for place in sources(target):
            files = _files_below(place) if place.is_dir() else [(place.parent, place)]
            for _, path in files:
                hasher.update(_named(str(path), path.read_bytes()))
    return hasher.digest()


def _of_package(package: PackageFiles, search: SearchPath) -> bytes:
    """The digest of package.xml and CMakeLists.txt of a package, and of the files that these refer to."""
    hasher = hashlib.sha256(repr((package.name, package.partial)).encode(errors="surrogateescape"))
    sources: list[Source] = []
    if package.declared is not None:
        sources.append(package.declared.source)
        hasher.update(dependencies.asked(package, search).encode())
    if package.listed is not None:
        hasher.update(repr(package.listed).encode(errors="surrogateescape"))
        sources += [] if package.listed.span is None else [package.listed.span.source]
        sources += (source for found in package.listed.diagnostics for source in sources_of(found))
    for source in sources:
        hasher.update(_named(str(source.path), _of_source(source)))
    return hasher.digest()


def _needed_types(interface: Interface) -> Iterator[str]:
    """The names of the types that an interface needs itself, those included that every action needs."""
    for message in _parts(interface):
        for _, type_ in references(message):
            yield type_.type_name
    if isinstance(interface, Action):
        yield from map("/".join, derive.ACTION_SUPPORT)


def _parts(interface: Interface) -> tuple[Message, ...]:
    return (interface,) if isinstance(interface, Message) else interface.messages


def _files_below(folder: Path) -> Iterator[tuple[Path, Path]]:
    """The folder and a file in it, for each."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix != ".pyc":
            yield folder, path


def _named(name: str, content: bytes) -> bytes:
    return f"{name}\0".encode(errors="surrogateescape") + hashlib.sha256(content).digest()

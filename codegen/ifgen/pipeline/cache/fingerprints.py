"""Digests of what generated files and warnings come from: where they are the same, so is what comes out."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable, Iterator, Mapping
from copy import copy
from itertools import chain
from pathlib import Path

from ifgen import resources
from ifgen.config import ros_distro
from ifgen.config.customization import Customization
from ifgen.definition import dependencies, derive
from ifgen.definition.interfaces import Action, Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.diagnostics import Source
from ifgen.pipeline.cache.record import PackageRecord, sources_of
from ifgen.pipeline.values import Request, ResolvedInput
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath
from ifgen.reading.storage import MAX_GENERATED, read_limited


class Fingerprints:
    """Digests of the sources of packages; each file is read once.

    What is the same for all packages, and what packages say about themselves, is read at once.
    """

    def __init__(self, request: Request) -> None:
        self._search = request.search
        self._generator = of_generator(resources.templates()) + _of_customization(request.custom)
        self._packages = {package.name: _of_package(package, self._search) for package in request.packages}
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
        return same

    def of_sources(self, name: str, sources: PackageRecord, ours: Iterable[str]) -> str:
        """The digest of everything that the files of a package depend on.

        `ours` are all packages in the output, if that matters.
        """
        hasher = hashlib.sha256(self._generator + self._packages.get(name, b""))
        hasher.update(repr(sorted(ours)).encode())
        types = ((type_name, self._of_type(type_name)) for type_name in (*sources.own, *sources.needed))
        documents = ((path, self._of_document(path)) for path in sources.documents)
        for source, digest in (*types, *documents):
            hasher.update(source.encode(errors="surrogateescape"))
            hasher.update(digest)
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
    # A wheel has these in the package too, and what matters of them counts by itself.
    others = (resources.bundled_interfaces(), resources.bundled_nodes(), resources.examples())
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


def of_files(paths: Iterable[Path]) -> dict[str, bytes]:
    """The digests of files, by their paths."""
    return {str(path): of_file(path) for path in paths}


def _of_text(data: bytes) -> bytes:
    """The digest of a text. Line ends do not count, as they do not for the parser."""
    return hashlib.sha256(data.replace(b"\r\n", b"\n")).digest()


def _of_source(source: Source) -> bytes:
    return _of_text(source.text.encode(errors="surrogateescape"))


def _of_customization(custom: Customization) -> bytes:
    """The digest of all the user's additions, empty if there are none."""
    is_old = ros_distro.is_old(custom.ros_distro)
    if custom == Customization(partial=custom.partial, ros_distro=custom.ros_distro) and not is_old:
        return b""
    values = (custom.outputs, custom.tests, custom.distributions, sorted(custom.requirements.items()), is_old)
    hasher = hashlib.sha256(repr(values).encode(errors="surrogateescape"))
    paths = [path for folder in custom.folders for _, path in _files_below(folder)]
    for path in (*paths, *([custom.filters] if custom.filters else ())):
        if path.is_file():
            hasher.update(_named(str(path), _of_text(read_limited(path, MAX_GENERATED))))
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

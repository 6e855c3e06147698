"""Digests of what generated files and warnings come from: where they are the same, so is what comes out."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path

from ifgen import resources
from ifgen.config import ros_distro
from ifgen.config.customization import Customization
from ifgen.definition import dependencies, derive
from ifgen.definition.interfaces import Action, Interface, Message, Registry
from ifgen.definition.references import references
from ifgen.diagnostics import Diagnostic, Source
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath
from ifgen.reading.storage import MAX_GENERATED, read_limited


def of_text(data: bytes) -> bytes:
    """The digest of a file. Line ends do not count, as they do not for the parser."""
    return hashlib.sha256(data.replace(b"\r\n", b"\n")).digest()


def of_source(source: Source) -> bytes:
    """The digest of a file as it was read."""
    return of_text(source.text.encode(errors="surrogateescape"))


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


def of_customization(custom: Customization) -> bytes:
    """The digest of all the user's additions, empty if there are none."""
    is_old = ros_distro.is_old(custom.ros_distro)
    if custom == Customization(partial=custom.partial, ros_distro=custom.ros_distro) and not is_old:
        return b""
    said = (custom.outputs, custom.tests, custom.distributions, sorted(custom.requirements.items()), is_old)
    hasher = hashlib.sha256(repr(said).encode(errors="surrogateescape"))
    paths = [path for folder in custom.folders for _, path in _files_below(folder)]
    for path in (*paths, *([custom.filters] if custom.filters else ())):
        if path.is_file():
            hasher.update(_named(str(path), of_text(read_limited(path, MAX_GENERATED))))
    return hasher.digest()


def of_modules(registry: Registry, generator: bytes) -> dict[str, str]:
    """By type name, of everything that the module of an interface depends on.

    It covers the text of the interface, of all interfaces that its fields need, and the generator.
    """
    interfaces = {part.type_name: interface for interface in registry for part in _parts(interface)}
    interfaces |= {interface.type_name: interface for interface in registry}
    texts = {i.type_name: of_source(i.source) if i.source is not None else b"" for i in registry}
    named = {name: _named(name, text) for name, text in texts.items()}
    direct = {i.type_name: {interfaces[name].type_name for name in needed_types(i)} for i in registry}
    return {name: _of_module(name, direct, named, generator) for name in direct}


def _of_module(
    name: str, direct: Mapping[str, set[str]], named: Mapping[str, bytes], generator: bytes
) -> str:
    found = {name}
    pending = [name]
    while pending:
        more = direct[pending.pop()] - found
        found |= more
        pending += more
    hasher = hashlib.sha256(generator + name.encode())
    for needed in sorted(found):
        hasher.update(named[needed])
    return hasher.hexdigest()[:32]


def of_own_description(package: PackageFiles, search: SearchPath) -> bytes:
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
        hasher.update(_named(str(source.path), of_source(source)))
    return hasher.digest()


def of_files(paths: Iterable[Path]) -> dict[str, bytes]:
    """The digests of files, by their paths."""
    return {str(path): of_file(path) for path in paths}


def of_file(path: Path) -> bytes:
    """The digest of a file; of nothing if it cannot be read."""
    try:
        return of_text(read_limited(path))
    except OSError:
        return b""


def needed_types(interface: Interface) -> Iterator[str]:
    """The names of the types that an interface needs itself, those included that every action needs."""
    for message in _parts(interface):
        for _, type_ in references(message):
            yield type_.type_name
    if isinstance(interface, Action):
        yield from map("/".join, derive.ACTION_SUPPORT)


def sources_of(diagnostic: Diagnostic) -> Iterator[Source]:
    """The files that a diagnostic points at."""
    if diagnostic.primary is not None:
        for label in (diagnostic.primary, *diagnostic.secondary):
            yield label.span.source


def _parts(interface: Interface) -> tuple[Message, ...]:
    return (interface,) if isinstance(interface, Message) else interface.messages


def _files_below(folder: Path) -> Iterator[tuple[Path, Path]]:
    """The folder and a file in it, for each."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix != ".pyc":
            yield folder, path


def _named(name: str, content: bytes) -> bytes:
    return f"{name}\0".encode(errors="surrogateescape") + hashlib.sha256(content).digest()

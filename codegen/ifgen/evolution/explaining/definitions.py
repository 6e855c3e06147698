"""Definitions of a type: those that two nodes have, and those that are installed, and where."""

from __future__ import annotations

import ast
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Final, TypeAlias

from ifgen import resources
from ifgen.config.settings import Settings, settle
from ifgen.definition.described.reading import read
from ifgen.definition.described.texts import TextFile, read_sources
from ifgen.definition.interfaces import Registry
from ifgen.definition.names import snake_case
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import Described, TypeHashes, described_types
from ifgen.diagnostics import InputError, Source, UsageError, shown_path
from ifgen.evolution.lock.text import NAME
from ifgen.reading import storage
from ifgen.reading.package_files import (
    FOLDERS,
    InterfaceFile,
    PackageFiles,
    installed_files,
    installed_shares,
)
from ifgen.reading.packages import find_what_can_be
from ifgen.reading.search_path import SearchPath

_MOST_TEXT: Final = 2**17
"""Characters of the sources that a node may send."""


@dataclass(frozen=True, slots=True)
class Known:
    """A definition of a type, with all that it holds.

    `place` counts the places where one that is installed was not found; the first ones are the project's.
    """

    described: Described
    registry: Registry
    place: int = 0


def of_sources(side: Mapping[str, Any], type_name: str, node: str | None) -> Known | None:
    """The definition in the sources of a side of a mismatch, if it has some and they fit its hash.

    Its places are those of a `node`, if any.
    """
    definition: Mapping[str, Any] | None = side["definition"]
    if not definition:
        return None
    try:
        texts = [(str(name), str(encoding), str(text)) for name, encoding, text in definition["sources"]]
        if sum(len(text) for _, _, text in texts) > _MOST_TEXT:
            return None
        found = read_sources(type_name, texts, Path(), node)
    except (InputError, TypeError, ValueError):
        return None
    return None if found is None else _fitting(type_name, side["type_hash"], found[1])


def of_document(side: Mapping[str, Any]) -> Known | None:
    """The definition in the type description of a side, without places; None if it does not fit its hash."""
    definition: Mapping[str, Any] | None = side["definition"]
    try:
        return Known(*read(definition["document"], side["type_hash"])) if definition else None
    except InputError:
        return None


class Installed:
    """The definitions that are installed, as far as they can be found in time.

    `patience` [s] is for all searches together, the first place of each excepted. `include` are folders
    besides those of the configuration.
    """

    def __init__(self, patience: float, include: Sequence[Path] = ()) -> None:
        self._patience = patience
        self._include = include
        self._found: dict[tuple[str, str], Known | None] = {}

    def definition(self, type_name: str, type_hash: str) -> Known | None:
        """The definition with a hash; None if there is none."""
        if type_name.count("/") != 2:
            return None  # whoever sent it knows no type either
        key = type_name, type_hash
        if key not in self._found:
            self._found[key] = next(self._definitions(type_name, type_hash), None)
        return self._found[key]

    def located(self, source: Source) -> Source:
        """The same source with the path of a file that has its text, if there is one."""
        package, folder, file_name = source.path.parts[-3:]
        for place in self._in_time(self._with_files):
            try:
                found = place(package)
                file = found.interface(folder, Path(file_name).stem) if found is not None else None
                if file is not None and file.read().text == source.text:
                    return replace(source, path=file.path)
            except (InputError, OSError):
                continue
        return source

    @cached_property
    def _until(self) -> float:
        return time.monotonic() + self._patience

    def _in_time(self, every: Iterable[Place]) -> Iterator[Place]:
        """The places that there is time for, one at least."""
        until = self._until
        for place in every:
            yield place
            if time.monotonic() > until:
                break

    @cached_property
    def _settings(self) -> Settings:
        try:
            return settle(include=self._include)
        except (UsageError, OSError):
            return settle(include=self._include, isolated=True)

    @cached_property
    def _with_files(self) -> list[Place]:
        return list(with_files(self._settings))

    def _definitions(self, type_name: str, type_hash: str) -> Iterator[Known]:
        every = [*self._with_files, *with_modules(self._settings)]
        for number, place in enumerate(self._in_time(every)):
            try:
                registry = _resolved(type_name, place, every)
            except (InputError, OSError):
                continue
            if registry is not None and (known := _fitting(type_name, type_hash, registry)):
                yield replace(known, place=number)
        yield from self._locked(type_name, type_hash, len(every))

    def _locked(self, type_name: str, type_hash: str, place: int) -> Iterator[Known]:
        from ifgen.evolution.lock import file as lock_file  # its parser, which most searches do without

        file = self._settings.file
        path = (file.parent if file is not None else Path.cwd()) / NAME
        try:
            source = lock_file.source(path)
            registry = lock_file.parse(source).registry if type_hash in source.text else None
        except InputError:
            return
        if registry is not None and (known := _fitting(type_name, type_hash, registry)):
            yield replace(known, place=place)


def _fitting(type_name: str, type_hash: str, registry: Registry) -> Known | None:
    """The type of this name and hash in a registry."""
    start, _, name = type_name.rpartition("/")
    for whole in wholes(name):
        interface = registry.get(f"{start}/{whole}")
        if interface is None:
            continue
        hashes = TypeHashes(registry)
        named = (d for d in described_types(interface) if d.type_name == type_name)
        return next((Known(d, registry) for d in named if hashes.of(d) == type_hash), None)
    return None


def _resolved(type_name: str, place: Place, every: Sequence[Place]) -> Registry | None:
    """A type as it is in one place, with what it holds: from there too, or else from the others."""
    package = place(type_name.partition("/")[0])
    file = file_of(type_name, package) if package is not None else None
    if package is None or file is None:
        return None
    asked = replace(package, files=(file,), partial=True, listed=None, nodes=())
    return resolve([asked], SearchFrom(place, every))


Place: TypeAlias = Callable[[str], PackageFiles | None]
"""Returns the package of a name, if it is there."""

_SOURCE: Final = "\n__source__ = "


def with_files(settings: Settings) -> Iterator[Place]:
    """The places of interface files, in the order in which `ifgen generate` looks into them."""
    for path in (settings.paths, *((folder,) for folder in settings.include)):
        if path:
            yield _source_packages(path)
    for share in (*installed_shares(), resources.bundled_interfaces()):
        yield _installed_packages(share)


def with_modules(settings: Settings) -> Iterator[Place]:
    """The places of generated packages: where Python imports from, and the output of the project."""
    for folder in dict.fromkeys((*map(Path, sys.path), settings.output)):
        yield _generated_packages(folder)


class SearchFrom(SearchPath):
    """Finds packages in the first of some places, then in the others, and nowhere else."""

    def __init__(self, first: Place, places: Sequence[Place]) -> None:
        super().__init__()
        self._places = (first, *(place for place in places if place is not first))

    def package(self, name: str) -> PackageFiles | None:
        """The package of this name; None if it is nowhere."""
        return next((found for place in self._places if (found := place(name))), None)


def file_of(type_name: str, package: PackageFiles) -> InterfaceFile | None:
    """The file that defines a type, or of which it is a part."""
    _, folder, name = type_name.split("/", 2)
    return next((file for whole in wholes(name) if (file := package.interface(folder, whole))), None)


def wholes(name: str) -> Iterator[str]:
    """A name, and those that it may be derived from: `Walk_SendGoal_Request`, `Walk_SendGoal`, `Walk`."""
    yield name
    while "_" in name:
        name = name.rpartition("_")[0]
        yield name


def _source_packages(paths: Sequence[Path]) -> Place:
    @cache
    def packages() -> dict[str, PackageFiles]:
        try:
            return {package.name: package for package in find_what_can_be(paths)[0]}
        except (InputError, OSError):
            return {}

    return lambda name: packages().get(name)


def _installed_packages(share: Path) -> Place:
    @cache
    def package(name: str) -> PackageFiles | None:
        files = installed_files(share / name)
        return PackageFiles(name, share / name, files) if files else None

    return package


def _generated_packages(folder: Path) -> Place:
    def package(name: str) -> PackageFiles | None:
        root = folder / name
        is_there = any(storage.is_folder(root / kind) for kind in FOLDERS)
        return _GeneratedPackage(name, root, ()) if is_there else None

    return package


class _GeneratedPackage(PackageFiles):
    """A package that ifgen generated: each module has the text that it was generated from."""

    def interface(self, folder: str, name: str) -> InterfaceFile | None:
        """The definition in a module; None if there is no such module, or no definition in it."""
        module = self.root / folder / f"_{snake_case(name)}.py"
        found = _assigned(storage.text_if_there(module) or "")
        source, encoding = found.get("__source__"), found.get("__encoding__")
        if not source:
            return None
        extension = "idl" if encoding == "idl" else folder
        path = Path(self.name) / folder / f"{name}.{extension}"
        return TextFile(path, folder, source, shown_path(self.root.parent))


def _assigned(text: str) -> dict[str, str]:
    """The texts that the end of a generated module assigns to names; it is read, never run."""
    start = text.rfind(_SOURCE)
    if start < 0:
        return {}
    try:
        statements = ast.parse(text[start:]).body
        return {
            statement.targets[0].id: str(ast.literal_eval(statement.value))
            for statement in statements
            if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name)
        }
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return {}

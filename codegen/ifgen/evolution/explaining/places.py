"""Where definitions may be installed: the project, its `include` folders, ROS, and generated packages."""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Final, TypeAlias

from ifgen import resources
from ifgen.config.settings import Settings
from ifgen.definition.described.texts import TextFile
from ifgen.definition.names import snake_case
from ifgen.diagnostics import InputError, shown_path
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

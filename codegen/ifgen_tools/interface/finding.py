"""Which interfaces can be found here, by package and kind."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Final

from ifgen.command_kit.tool import ToolError, did_you_mean
from ifgen.config.settings import settle
from ifgen.definition.interfaces import Registry
from ifgen.definition.type_description import Described
from ifgen.diagnostics import UsageError
from ifgen.pipeline.lookup import find_type
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

HEADINGS: Final = {"msg": "Messages", "srv": "Services", "action": "Actions"}
"""Above the interfaces of each kind in a list."""


def search_path(include: tuple[Path, ...]) -> SearchPath:
    """Where to look for types: the paths of the configuration first."""
    settings = settle(None, None, include)
    return SearchPath(find_packages(settings.paths), settings.include)


def find(name: str, search: SearchPath) -> tuple[Described, Registry]:
    """The type of a name, and all that it needs. ToolError if there is none, InputError if it is wrong."""
    try:
        return find_type(name, search)
    except UsageError as error:
        first = error.diagnostics[0]
        raise ToolError(first.message, first.help or "") from None


def all_types(search: SearchPath) -> Iterator[tuple[str, str]]:
    """Kind and name of every type, sorted by name."""
    for package in search.package_names():
        yield from types_of(package, search)


def types_of(package_name: str, search: SearchPath) -> list[tuple[str, str]]:
    """Kind and name of the types in a package, sorted by name. ToolError if there is no such package."""
    package = search.package(package_name)
    files = package.known_files() if package else []
    if not files:
        near = did_you_mean(package_name, search.package_names())
        raise ToolError(f"unknown package {package_name!r}", near or "see `ifgen interface packages`")
    return sorted({(file.folder, f"{package_name}/{file.folder}/{file.name}") for file in files}, key=_name)


def packages_with(kinds: Collection[str], search: SearchPath) -> list[str]:
    """The packages that have interfaces of one of these kinds."""
    return [p for p in search.package_names() if any(kind in kinds for kind, _ in types_of(p, search))]


def _name(found: tuple[str, str]) -> str:
    return found[1]

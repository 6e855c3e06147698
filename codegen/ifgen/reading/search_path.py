"""Where packages are looked for that others depend on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from functools import cached_property
from pathlib import Path
from typing import Final, Literal

from ifgen import resources
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.reading import package_xml, storage
from ifgen.reading.package_files import (
    NodeFile,
    PackageFiles,
    installed_files,
    installed_shares,
    nodes_below,
)
from ifgen.reading.package_xml import PackageXml
from ifgen.reading.packages import packages_at

_MAX_FILE_NAME: Final = 255  # bytes, on all systems; names of packages are ASCII


WithDeps = bool | Literal["own"]
"""The dependencies to generate: none, all, or those that are in the folders of `-I`."""


class SearchPath:
    """Finds the packages that others depend on, by name and only when asked.

    In this order: the packages given, the folders to include, AMENT_PREFIX_PATH, the interpreter's own
    `share` folder (where the ros-* wheels put theirs) and its packages (where pip puts those that ifgen made
    installable), and the packages that come with ifgen. InputError if one of the folders to include does
    not exist.
    """

    def __init__(self, given: Sequence[PackageFiles] = (), include: Sequence[Path | str] = ()) -> None:
        self._known: dict[str, PackageFiles | None] = {package.name: package for package in given}
        self._xmls: dict[str, PackageXml | None] = {}
        self._include = [Path(path) for path in include]
        missing = [path for path in self._include if not storage.exists(path)]
        if missing:
            raise InputError(
                Diagnostic("unreadable-path", f"there is no {path} to include") for path in missing
            )

    def package(self, name: str) -> PackageFiles | None:
        """The package of this name; None if it is nowhere."""
        if len(name) > _MAX_FILE_NAME:
            return None
        if name not in self._known:
            self._known[name] = self._look_for(name)
        return self._known[name]

    def knowing(self, packages: Iterable[PackageFiles]) -> SearchPath:
        """The same with these packages in the place of those of their names."""
        search = copy(self)
        search._known = {**self._known, **{package.name: package for package in packages}}
        return search

    def found(self) -> list[PackageFiles]:
        """The packages that were asked for and found so far."""
        return [package for package in self._known.values() if package is not None]

    def comes_along(self, name: str, with_deps: WithDeps) -> bool:
        """Whether a dependency is to be generated too."""
        return name in self._included if with_deps == "own" else with_deps

    def is_own(self, name: str) -> bool:
        """Whether a package that was not asked for is in the folders to include."""
        package = self.package(name)
        return package is not None and package is self._included.get(name)

    def find_node(self, package_name: str, name: str) -> NodeFile | None:
        """The NoDL document `nodl://package/name`: of a package that is found, or in the ament index."""
        package = self.package(package_name)
        for node in package.known_nodes() if package else ():
            if node.name == name:
                return node
        key = f"{package_name}__{name}"
        if "/" in key or len(key) > _MAX_FILE_NAME:
            return None
        indexes = (share / "ament_index" / "resource_index" / "nodl" / key for share in self._shares)
        return next((NodeFile(path) for path in indexes if storage.is_file(path)), None)

    def package_xml(self, name: str) -> PackageXml | None:
        """The package.xml of any package, with or without interfaces; None if it is unknown."""
        package = self.package(name)
        if package is not None and package.xml is not None:
            return package.xml
        if name not in self._xmls:
            roots = [package.root] if package else [share / name for share in self._shares]
            self._xmls[name] = next((xml for root in roots if (xml := package_xml.read(root, []))), None)
        return self._xmls[name]

    def places(self) -> list[str]:
        """The places to search after the given packages, in order."""
        return [str(path) for path in (*self._include, *self._shares)]

    def package_names(self) -> list[str]:
        """The names of all packages with interfaces that can be found."""
        found = (
            (name, package) for known in (self._known, self._included) for name, package in known.items()
        )
        names = {name for name, package in found if package and package.known_files()}
        for share in self._shares:
            if storage.is_folder(share):
                below = (entry.name for entry in storage.entries(share))
                names.update(name for name in below if installed_files(share / name))
        return sorted(names)

    def packages_with(self, interface: str, folder: str = "msg") -> list[str]:
        """The names of all packages that have an interface of this name in a folder."""
        return [
            name
            for name in self.package_names()
            if (package := self.package(name)) and package.interface(folder, interface)
        ]

    def _look_for(self, name: str) -> PackageFiles | None:
        if name in self._included:
            return self._included[name]
        for share in self._shares:
            nodes, files = nodes_below(share / name), installed_files(share / name)
            if files or nodes:
                return PackageFiles(name, share / name, files, nodes=nodes)
        return None

    @cached_property
    def _included(self) -> Mapping[str, PackageFiles]:
        included: dict[str, PackageFiles] = {}
        for path in self._include:
            # A search for another package ignores mistakes in this package.xml.
            for package in packages_at(path, []):
                included.setdefault(package.name, package)
        return included

    @cached_property
    def _shares(self) -> Sequence[Path]:
        return [*installed_shares(), resources.bundled_interfaces()]

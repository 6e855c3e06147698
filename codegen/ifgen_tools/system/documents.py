"""The document of each node that a launch file starts, by its package and its executable."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

from ifgen.definition.interfaces import Registry
from ifgen.definition.type_description import TypeHashes
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.evolution.lock import file as lock
from ifgen.nodl import barriers
from ifgen.nodl.load import Loaded, load_document, registry_of
from ifgen.nodl.model import Interface, NodeDescription
from ifgen.reading.packages import NodeFile
from ifgen.reading.search_path import SearchPath

LOCK: Final = "ifgen.lock"


class Documents:
    """Documents of nodes, each read once: in packages of a project or installed ones, and in ament's index.

    `findings` is what is wrong with those that were read.
    """

    def __init__(self, search: SearchPath) -> None:
        self.search = search
        self.findings: list[Diagnostic] = []
        self._loaded: dict[Path, Loaded | None] = {}
        self._locks: dict[Path, dict[str, str]] = {}

    def of(self, package: str, executable: str, name: str) -> NodeDescription | None:
        """The description of a node; None if no document is found."""
        file = self._file(package, _names(executable, name))
        loaded = self._load(file.path) if file else None
        return loaded.description if loaded else None

    def names(self, package: str) -> list[str]:
        """The names of the documents of a package."""
        found = self.search.package(package)
        return [each.name for each in found.known_nodes()] if found else []

    def knows_package(self, package: str) -> bool:
        """Whether there is a package of this name with interfaces or documents."""
        return self.search.package(package) is not None

    def framework(self, description: NodeDescription) -> Interface:
        """The endpoints that a node has without its author's doing, beside those that its documents name."""
        key = "lifecycle_node" if description.style == "lifecycle" or _is_lifecycle(description) else "node"
        loaded = self._load(barriers.OFFICIAL["nodl_common_interfaces", key])
        return loaded.whole if loaded else Interface()

    def hashes(self, type_names: Iterable[str]) -> tuple[dict[str, str], Registry]:
        """The hash of each of these types that can be found, and their definitions."""
        names = set(type_names)
        try:
            registry = registry_of(names, self.search)
        except InputError as error:
            self.findings += (found for found in error.diagnostics if found.severity == "error")
            return {}, Registry.of_interfaces(())
        hashes = TypeHashes(registry)
        return {each.type_name: hashes.of(each) for each in registry if each.type_name in names}, registry

    def locked(self, description: NodeDescription) -> dict[str, str]:
        """The hashes that the lock file of a node's package has: what the node was built against."""
        path = description.path.parents[1] / LOCK if description.path else None
        if path is None or not path.is_file():
            return {}
        if path not in self._locks:
            try:
                self._locks[path] = dict(lock.read(path).hashes)
            except InputError as error:
                self.findings += error.diagnostics
                self._locks[path] = {}
        return self._locks[path]

    def _file(self, package: str, names: Iterable[str]) -> NodeFile | None:
        if not package:
            return None
        found = self.search.package(package)
        nodes = found.known_nodes() if found else []
        wanted = list(names)
        for name in wanted:
            if file := next((each for each in nodes if each.name == name), None):
                return file
            if file := self.search.find_node(package, name):
                return file
        return None

    def _load(self, path: Path) -> Loaded | None:
        if path not in self._loaded:
            self._loaded[path], findings = load_document(path, self.search)
            self.findings += (each for each in findings if each.severity == "error")
        return self._loaded[path]


def _is_lifecycle(description: NodeDescription) -> bool:
    return description.base is not None and description.base.is_lifecycle


def _names(executable: str, name: str) -> Iterator[str]:
    """The names that the document of a node may have, the likeliest first."""
    last = executable.rpartition("::")[2].removesuffix(".py")
    yield last
    snake = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", last).lower()
    yield from (each for each in (snake, snake.removesuffix("_node"), name) if each and each != last)

"""Packages of nodes written to a temporary folder, and the result of loading them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.nodl.load import load
from ifgen.nodl.model import NodeDescription, Nodes
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath


@dataclass(frozen=True)
class Loaded:
    """The nodes, or None and the reason; warnings are among the diagnostics."""

    nodes: Nodes | None
    diagnostics: tuple[Diagnostic, ...]

    @property
    def node(self) -> NodeDescription:
        """The only node."""
        assert self.nodes is not None, [d.message for d in self.diagnostics]
        [package] = self.nodes.packages
        [node] = package.nodes
        return node

    @property
    def rules(self) -> list[str]:
        """The rules that are broken."""
        return [diagnostic.rule for diagnostic in self.diagnostics]


Load = Callable[[str | bytes | Mapping[str, str | bytes]], Loaded]


def load_from(root: Path, files: Mapping[str, str | bytes]) -> Loaded:
    """Write files below a folder, and load the packages in it."""
    for name, content in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    try:
        packages = find_packages([root])
        nodes = load(packages, SearchPath(packages))
    except InputError as error:
        return Loaded(None, error.diagnostics)
    return Loaded(nodes, nodes.warnings)


@pytest.fixture
def load_nodes(tmp_path: Path) -> Load:
    """Load the text of demo/nodl/talker.nodl.yaml, or several files by their paths."""

    def load_them(files: str | bytes | Mapping[str, str | bytes]) -> Loaded:
        if isinstance(files, str | bytes):
            files = {"demo/nodl/talker.nodl.yaml": files}
        return load_from(tmp_path, files)

    return load_them

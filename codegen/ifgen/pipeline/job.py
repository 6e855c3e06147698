"""The values between the stages of a run: what its packages mean, and the files planned for them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.definition.interfaces import InterfacePackage, Registry
from ifgen.diagnostics import Diagnostic
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.reading import package_xml
from ifgen.reading.packages import NODE_FOLDER, PackageFiles, node_name

if TYPE_CHECKING:
    from ifgen.nodl.model import NodePackage, Nodes


@dataclass(frozen=True, slots=True)
class Target:
    """A package to generate: its interfaces, its nodes, or both."""

    name: str
    interfaces: InterfacePackage | None
    nodes: NodePackage | None

    @property
    def import_folder(self) -> str:
        """The folder that Python imports, from the output folder."""
        return self.name if self.nodes is None else f"{self.name}/{self.name}"

    @property
    def described(self) -> tuple[str, ...]:
        """Its descriptions of nodes, and of parts of nodes, as `pkg/nodl/name`."""
        files = self.nodes.sources if self.nodes else ()
        root = self.nodes.root.resolve() / NODE_FOLDER if self.nodes else None
        own = (node_name(file.path.name) for file in files if file.path.resolve().parent == root)
        return tuple(f"{self.name}/{NODE_FOLDER}/{name}" for name in own if name)

    @property
    def documents(self) -> tuple[Path, ...]:
        """The paths of everything that was read for its nodes."""
        if self.nodes is None:
            return ()
        return (*(source.path for source in self.nodes.sources), self.nodes.root / package_xml.NAME)


@dataclass(frozen=True, slots=True)
class Job:
    """The packages of a run, into the folder `output`; `registry` has what their interfaces need."""

    packages: tuple[PackageFiles, ...]
    registry: Registry
    nodes: Nodes | None
    targets: tuple[Target, ...]
    output: Path

    @property
    def registries(self) -> tuple[Registry, ...]:
        """The packages that interfaces need, and those that nodes need, if there are any."""
        return (self.registry, self.nodes.registry) if self.nodes else (self.registry,)

    @property
    def needed(self) -> set[str]:
        """The packages that are needed and not generated."""
        names = {name for registry in self.registries for name in registry.packages}
        return names - {target.name for target in self.targets}

    def warnings(self) -> tuple[Diagnostic, ...]:
        """The diagnostics about everything that was read, and about the user's modules in the output."""
        of_nodes = self.nodes.warnings if self.nodes else ()
        return tuple(dict.fromkeys((*self.registry.warnings, *of_nodes, *self._about_users_modules())))

    def _about_users_modules(self) -> Iterator[Diagnostic]:
        for target in self.targets:
            if target.nodes is not None:
                from ifgen.pipeline.user_code import compare  # of no use where there are interfaces only

                yield from compare(target.nodes, self.output / target.import_folder)


@dataclass(frozen=True, slots=True)
class PlannedPackage:
    """An `OutputPackage` to be: what each of its files is made of, or its text where that is known."""

    name: str
    files: Mapping[str, Artifact | OutputFile]
    interfaces: tuple[str, ...] = ()
    source: str | None = None
    beside: Mapping[str, Artifact] = field(default_factory=dict[str, Artifact])
    once: Mapping[str, Artifact] = field(default_factory=dict[str, Artifact])

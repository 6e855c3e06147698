"""The values of a run, from the request to the files that were built."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization
from ifgen.definition.interfaces import InterfacePackage, Registry
from ifgen.diagnostics import Diagnostic
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.reading import package_xml
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles, node_name
from ifgen.reading.search_path import SearchPath, WithDeps
from ifgen.writing.write import OutputPackage, TargetFolder

if TYPE_CHECKING:
    from ifgen.nodl.model import NodePackage, Nodes

Progress = Callable[[int, int, str], object]
"""Called with the packages done, the packages in all, and the one that is next."""


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition for a run: `check` raises InputError if the interfaces of the run do not meet it.

    `key` is different for conditions that are different: a run that met one need not check it again.
    """

    key: str
    check: Callable[[Iterable[Registry]], None]


@dataclass(frozen=True, slots=True)
class Request:
    """The packages at `paths` to generate into the folder `output`, and the places to look for others.

    `previous` are the manifests of the packages that earlier runs left there. `with_deps` says which
    dependencies come along, `custom` has what the user adds. A run that does not meet the `condition` writes
    nothing. `excluded` are the names of packages, interfaces and nodes that the user leaves out; a run that
    is to `keep_going` leaves out what is wrong, too.
    """

    paths: tuple[Path, ...]
    packages: tuple[PackageFiles, ...]
    search: SearchPath
    output: Path
    previous: Mapping[str, Manifest]
    with_deps: WithDeps = False
    custom: Customization = Customization()  # noqa: RUF009 - it is frozen
    condition: Condition | None = None
    excluded: tuple[str, ...] = ()
    keep_going: bool = False

    def source_of(self, package: PackageFiles) -> str:
        """The folder of a package that was asked for, seen from the output folder."""
        root = package.root.resolve()
        with suppress(ValueError):  # on another drive
            return Path(os.path.relpath(root, self.output.resolve())).as_posix()
        return root.as_posix()


@dataclass(frozen=True, slots=True)
class LeftOut:
    """The name of an interface, a node or a whole package that a run leaves out, and the reason."""

    name: str
    reason: str


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
class ResolvedInput:
    """The packages of a run, into the folder `output`; `registry` has what their interfaces need.

    `left_out` is in none of them, and the `mistakes` are the reason for some of that.
    """

    packages: tuple[PackageFiles, ...]
    registry: Registry
    nodes: Nodes | None
    targets: tuple[Target, ...]
    output: Path
    left_out: tuple[LeftOut, ...] = ()
    mistakes: tuple[Diagnostic, ...] = ()

    @property
    def registries(self) -> tuple[Registry, ...]:
        """The packages that interfaces need, and those that nodes need, if there are any."""
        return (self.registry, self.nodes.registry) if self.nodes else (self.registry,)

    @property
    def needed(self) -> set[str]:
        """The packages that are needed and not generated."""
        names = {name for registry in self.registries for name in registry.packages}
        return names - {target.name for target in self.targets}

    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The diagnostics about everything that was read, and about the user's modules in the output."""
        of_nodes = self.nodes.warnings if self.nodes else ()
        warnings = dict.fromkeys((*self.registry.warnings, *of_nodes, *self._about_users_modules()))
        return (*self.mistakes, *warnings)

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


@dataclass(frozen=True, slots=True)
class BuildResult:
    """The files that a run writes, and the diagnostics about their sources.

    `packages` are rendered when they are asked for, which is once: a large run has no room for all of them.
    `generated` are the names of its packages. Those among them that are `skipped` are on disk already, each
    with its manifest, and not in `packages`. `needed` are others that these need. `resolved` is None if
    nothing had to be. `targets` are the folders of generators, and `skipped_targets` those that are on disk.
    """

    packages: Iterable[OutputPackage]
    generated: Collection[str]
    needed: Collection[str]
    diagnostics: tuple[Diagnostic, ...]
    skipped: Mapping[str, Manifest]
    resolved: ResolvedInput | None = None
    targets: tuple[TargetFolder, ...] = ()
    skipped_targets: Mapping[Path, Manifest] = field(default_factory=dict[Path, Manifest])

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """The names that the run leaves out, which are not in `packages`."""
        return self.resolved.left_out if self.resolved else ()

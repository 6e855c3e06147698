"""What one run generates: the packages asked for, resolved, and their files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization
from ifgen.config.ros_distro import refused
from ifgen.definition.interfaces import InterfacePackage, Registry
from ifgen.diagnostics import Diagnostic, InterfaceError
from ifgen.reading import manifest, package_xml
from ifgen.reading.packages import NODE_FOLDER, PackageFiles, SearchPath, WithDeps, node_name
from ifgen.writing.write import ROOT, OutputPackage

if TYPE_CHECKING:
    from ifgen.nodl.model import NodePackage, Nodes
    from ifgen.pipeline.notes import Modules

Progress = Callable[[int, int, str], object]
"""Called with the packages done, the packages in all, and the one that is next."""


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

    @staticmethod
    def resolve(
        packages: tuple[PackageFiles, ...],
        search: SearchPath,
        output: Path,
        with_deps: WithDeps,
        ros_distro: str | None = None,
    ) -> Job:
        """Read and resolve everything. Raises InterfaceError with all that is wrong."""
        # Parsers are worth their imports only where something has changed.
        from ifgen.definition.problems import one_for_each_cause
        from ifgen.definition.resolve import resolve

        problems: list[Diagnostic] = []
        nodes = None
        if any(package.nodes for package in packages):
            from ifgen.nodl.load import load

            try:
                nodes = load(packages, search)
            except InterfaceError as error:
                problems += error.diagnostics
        with_interfaces = [package for package in packages if package.has_interfaces]
        if with_deps and nodes is not None:
            with_interfaces += _needed_by(nodes, with_interfaces, search, with_deps)
        try:
            registry = resolve(with_interfaces, search, with_deps)
        except InterfaceError as error:
            problems += error.diagnostics
            raise InterfaceError(one_for_each_cause(dict.fromkeys(problems))) from None
        problems += refused(registry.warnings, ros_distro)
        if problems:
            raise InterfaceError(problems)
        return Job(packages, registry, nodes, tuple(_targets(registry, nodes, search, with_deps)), output)

    def plan_and_render(
        self,
        targets: Sequence[Target],
        custom: Customization,
        progress: Progress | None,
        modules: Modules | None = None,
    ) -> list[OutputPackage]:
        """The files of some of the targets; `modules` may have some that need no work."""
        if not targets and not custom.outputs:
            return []
        # jinja2 is worth its import only where there is something to render.
        from ifgen.generator_py.templates.render import Templates
        from ifgen.pipeline.extra_outputs import ExtraOutputs
        from ifgen.pipeline.rendering import Rendering

        templates = Templates(custom)
        rendering = Rendering(self, custom, templates, modules)
        interfaces = [target.interfaces for target in self.targets if target.interfaces]
        nodes = {target.name: target.nodes.nodes for target in self.targets if target.nodes}
        import_folders = {target.name: target.import_folder for target in self.targets if target.nodes}
        extra = ExtraOutputs(custom, templates, self.registry, interfaces, nodes, import_folders)
        outputs: list[OutputPackage] = []
        for done, target in enumerate(targets):
            if progress:
                progress(done, len(targets), target.name)
            outputs.append(extra.add(rendering.package(target)))
        return [*outputs, *extra.of_run(_has_manifest(self.output / ROOT))]

    @property
    def needed(self) -> set[str]:
        """The packages that are needed and not generated."""
        registries = [self.registry, *([self.nodes.registry] if self.nodes else [])]
        names = {name for registry in registries for name in registry.packages}
        return names - {target.name for target in self.targets}

    def warnings(self) -> tuple[Diagnostic, ...]:
        """What there is to say about everything that was read, and about the user's modules in the output."""
        of_nodes = self.nodes.warnings if self.nodes else ()
        return tuple(dict.fromkeys((*self.registry.warnings, *of_nodes, *self._about_users_modules())))

    def _about_users_modules(self) -> Iterator[Diagnostic]:
        for target in self.targets:
            if target.nodes is not None:
                from ifgen.pipeline.user_code import compare  # of no use where there are interfaces only

                yield from compare(target.nodes, self.output / target.import_folder)


def _targets(
    registry: Registry, nodes: Nodes | None, search: SearchPath, with_deps: WithDeps
) -> Iterator[Target]:
    along = (name for name in registry.packages if search.comes_along(name, with_deps))
    names = dict.fromkeys((*registry.requested, *along))
    interfaces = {name: registry.packages[name] for name in names if registry.packages[name].interfaces}
    described = {package.name: package for package in nodes.packages if package.nodes} if nodes else {}
    for name in sorted({*interfaces, *described}):
        yield Target(name, interfaces.get(name), described.get(name))


def _needed_by(
    nodes: Nodes, present: Iterable[PackageFiles], search: SearchPath, with_deps: WithDeps
) -> Iterator[PackageFiles]:
    """The packages to generate whose interfaces nodes use, without those that are present."""
    known = {package.name for package in present}
    for name in sorted(nodes.registry.packages.keys() - known):
        package = search.find(name)
        if package is not None and search.comes_along(name, with_deps):
            yield package


def _has_manifest(folder: Path) -> bool:
    with suppress(OSError, ValueError):
        return manifest.read(folder) is not None
    return False

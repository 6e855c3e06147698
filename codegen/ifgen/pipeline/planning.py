"""From a job to planned files: which there are in each package, from which template, with what in it."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization, Distributions
from ifgen.definition.interfaces import InterfacePackage
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.generator_py.messages.classes import Facts
from ifgen.pipeline import earlier
from ifgen.pipeline.extra_outputs import ExtraOutputs
from ifgen.pipeline.job import Job, PlannedPackage, Target
from ifgen.pipeline.values import Progress
from ifgen.reading import manifest, package_xml
from ifgen.reading.packages import NODE_FOLDER
from ifgen.writing.write import ROOT

if TYPE_CHECKING:
    from ifgen.nodl.model import NodePackage
    from ifgen.pipeline.freshness.modules import Modules

# Late imports: a run may be about interfaces only, or about nodes.


def plan(
    job: Job,
    custom: Customization,
    skipped: Collection[str] = (),
    modules: Modules | None = None,
    progress: Progress | None = None,
) -> Iterator[PlannedPackage]:
    """The files of a job, a package at a time, so that `progress` hears of each; without those `skipped`.

    `modules` may have some that need no work. Raises InputError for outputs of the user's that cannot be.
    """
    targets = [target for target in job.targets if target.name not in skipped]
    if not targets and not custom.outputs:
        return
    planning = _Planning(job, custom, modules)
    extra = ExtraOutputs(custom, job)
    for done, target in enumerate(targets):
        if progress:
            progress(done, len(targets), target.name)
        yield extra.add(planning.package(target))
    yield from extra.of_run(_has_manifest(job.output / ROOT))


class _Planning:
    """Plans the packages of a job; `modules` are those of interfaces that need no work."""

    def __init__(self, job: Job, custom: Customization, modules: Modules | None) -> None:
        self._job = job
        self._tests = custom.tests
        self._distributions, self._requirements = custom.distributions, custom.requirements
        self._modules = modules
        self._facts = Facts(job.registry)
        self._sources = {package.name: earlier.source_of(package, job.output) for package in job.packages}

    def package(self, target: Target) -> PlannedPackage:
        """The files of a package."""
        ensured: tuple[str, ...] = ()
        names: list[str] = []
        files: list[Artifact | OutputFile] = []
        users: list[Artifact] = []
        if self._distributions is not None:
            from ifgen.generator_py.outputs import installable

            if installable.is_installable(target.name):
                ensured = installable.from_runtime(target.interfaces, target.nodes, self._job.registries)
                files += self._for_pip(target, self._distributions)
        if target.interfaces is not None:
            files += self._of_interfaces(target, target.interfaces, ensured)
            names += (f"{interface.folder}/{interface.name}" for interface in target.interfaces.interfaces)
        if target.nodes is not None:
            files += self._of_nodes(target.nodes, target.interfaces, ensured)
            users += self._of_users(target.nodes)
            names += (f"{NODE_FOLDER}/{node.name}" for node in target.nodes.nodes)
        source = self._sources.get(target.name)
        return PlannedPackage(
            target.name,
            {file.path: file for file in files},
            tuple(sorted(names)),
            source,
            once={file.path: file for file in users},
        )

    def _for_pip(self, target: Target, distributions: Distributions) -> Iterator[Artifact | OutputFile]:
        """The files that make a package installable by pip."""
        from ifgen.generator_py.outputs.installable import definitions, plan_project

        job = self._job
        root = next((package.root for package in job.packages if package.name == target.name), None)
        said = (package_xml.texts(root) if root else None) or {}
        ours = {target.name for target in job.targets} | earlier.packages_in(job.output)
        yield plan_project(
            target.name, target.interfaces, target.nodes, said, distributions, self._requirements, ours
        )
        for path, text in definitions(target.interfaces).items() if target.interfaces else ():
            yield OutputFile(_inner(target) + path, text)

    def _of_interfaces(
        self, target: Target, package: InterfacePackage, ensured: tuple[str, ...]
    ) -> Iterator[Artifact | OutputFile]:
        from ifgen.generator_py.messages.package import module_path, plan_interface, plan_shared
        from ifgen.generator_py.tests.package import plan_interface_tests

        for artifact in plan_shared(package, ensured):
            yield replace(artifact, path=_inner(target) + artifact.path)
        for interface in package.interfaces:
            path = _inner(target) + module_path(interface)
            text = self._modules.text(interface, path) if self._modules else None
            if text is not None:
                yield OutputFile(path, text)
            else:
                yield replace(plan_interface(interface, self._facts), path=path)
        if self._tests:
            yield from plan_interface_tests(package, self._job.registry)

    def _of_nodes(
        self, package: NodePackage, interfaces: InterfacePackage | None, ensured: tuple[str, ...]
    ) -> Iterator[Artifact]:
        from ifgen.generator_py.nodes.package import plan_nodes
        from ifgen.generator_py.tests.package import plan_node_tests

        yield from plan_nodes(package, interfaces, ensured, self._requirements)
        if self._tests and self._job.nodes is not None:
            yield from plan_node_tests(package, self._job.nodes.registry)

    def _of_users(self, package: NodePackage) -> Iterator[Artifact]:
        """The files that are the user's once they are written."""
        from ifgen.generator_py.nodes.package import plan_users_files
        from ifgen.generator_py.tests.package import plan_users_tests

        yield from plan_users_files(package)
        if self._tests and self._job.nodes is not None:
            yield from plan_users_tests(package, self._job.nodes.registry)


def _inner(target: Target) -> str:
    """The folder from which Python imports interfaces, in the folder of their package."""
    return "" if target.nodes is None else f"{target.name}/"


def _has_manifest(folder: Path) -> bool:
    with suppress(OSError, ValueError):
        return manifest.read(folder) is not None
    return False

"""Plans the outputs of `[tool.ifgen.outputs]` and adds them to the packages that they come and go with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization
from ifgen.definition.interfaces import InterfacePackage, Registry
from ifgen.diagnostics import Diagnostic, InputError, Label
from ifgen.pipeline.job import Job, PlannedPackage
from ifgen.writing.write import ROOT

if TYPE_CHECKING:
    from ifgen.generator_py.outputs.plan import PlannedOutput
    from ifgen.generator_py.outputs.view import PackageView
    from ifgen.nodl.model import NodeDescription


class ExtraOutputs:
    """The outputs of a run: planned for all its packages, added to those that ask.

    Raises InputError for outputs that cannot be.
    """

    def __init__(self, custom: Customization, job: Job) -> None:
        self._custom = custom
        self._planned: tuple[PlannedOutput, ...] = ()
        if custom.outputs:
            from ifgen.generator_py.outputs.plan import plan_outputs  # of use to few

            interfaces = [target.interfaces for target in job.targets if target.interfaces]
            nodes = {target.name: target.nodes.nodes for target in job.targets if target.nodes}
            import_folders = {target.name: target.import_folder for target in job.targets if target.nodes}
            views = tuple(_views(job.registry, interfaces, nodes))
            self._planned = plan_outputs(custom.outputs, views, import_folders, partial=custom.partial)

    def add(self, package: PlannedPackage) -> PlannedPackage:
        """The package with its outputs, some of which may be beside it."""
        files, beside = dict(package.files), dict(package.beside)
        for planned in self._planned:
            if planned.package == package.name:
                path = planned.artifact.path
                inside = path.removeprefix(f"{package.name}/")
                is_beside = inside == path
                if path in beside if is_beside else inside in files or inside in package.once:
                    raise InputError([_taken(planned)])
                if is_beside:
                    beside[path] = planned.artifact
                else:
                    files[inside] = planned.artifact
        return replace(package, files=files, beside=beside)

    def of_run(self, present: bool) -> Iterator[PlannedPackage]:
        """The outputs of the whole run, if any; `present` is true if an earlier run made some."""
        planned = [p for p in self._planned if p.package is None]
        if planned or (present and not self._custom.partial):
            yield PlannedPackage(ROOT, {p.artifact.path: p.artifact for p in planned})


def _views(
    registry: Registry,
    packages: Sequence[InterfacePackage],
    nodes: Mapping[str, Sequence[NodeDescription]],
) -> Iterator[PackageView]:
    # Few users have outputs of their own.
    from ifgen.generator_py.outputs.build import interface_view, node_view
    from ifgen.generator_py.outputs.view import PackageView

    interfaces = {package.name: package.interfaces for package in packages}
    for name in sorted({*interfaces, *nodes}):
        yield PackageView(
            name,
            tuple(interface_view(interface, registry) for interface in interfaces.get(name, ())),
            tuple(map(node_view, sorted(nodes.get(name, ()), key=lambda node: node.name))),
        )


def _taken(planned: PlannedOutput) -> Diagnostic:
    output = planned.output
    label = None if output.span is None else Label(output.span)
    message = f"output '{output.name}' cannot be made: ifgen writes its own file at '{planned.artifact.path}'"
    return Diagnostic("same-path", message, label, help="replace the template of that file, or choose a path")

"""Plans the files of each package, which template makes each and with what in it, and renders them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from ifgen.config.customization import Customization, Distributions
from ifgen.definition.interfaces import InterfacePackage
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.generator_py.artifact import Artifact, OutputFile
from ifgen.generator_py.messages.classes import Facts
from ifgen.generator_py.messages.package import module_path, plan_interface, plan_shared
from ifgen.generator_py.templates.render import Templates
from ifgen.generator_py.tests.package import plan_interface_tests, plan_node_tests, plan_users_tests
from ifgen.pipeline.cache.fresh import UpToDate
from ifgen.pipeline.values import PlannedPackage, Progress, Request, ResolvedInput, Target
from ifgen.reading import package_xml
from ifgen.reading.packages import NODE_FOLDER
from ifgen.writing.write import ROOT, OutputPackage

if TYPE_CHECKING:
    from ifgen.generator_py.outputs.plan import PlannedOutput

# Late imports: what a run needs that is about nodes, makes packages for pip, or has outputs of the user's.


def plan(
    request: Request, resolved: ResolvedInput, up_to_date: UpToDate, progress: Progress | None = None
) -> Iterator[PlannedPackage]:
    """The files of a run that are not up to date, a package at a time, so that `progress` hears of each.

    Raises InputError for outputs of the user's that cannot be.
    """
    custom = request.custom
    targets = [target for target in resolved.targets if target.name not in up_to_date.packages]
    if not targets and not custom.outputs:
        return
    planning = _Planning(request, resolved, up_to_date)
    outputs = _Outputs(custom, resolved) if custom.outputs else None
    for done, target in enumerate(targets):
        if progress:
            progress(done, len(targets), target.name)
        package = planning.package(target)
        yield outputs.added_to(package) if outputs else package
    root = outputs.of_run() if outputs else {}
    # An earlier run may have made some, which go if there are none now.
    if root or (not custom.partial and ROOT in request.previous):
        yield PlannedPackage(ROOT, root)


def render(planned: Iterable[PlannedPackage], custom: Customization) -> Iterator[OutputPackage]:
    """The packages with the texts of their files. Raises InputError for a template that is wrong."""
    templates: Templates | None = None  # the user's filters are loaded only if they are needed
    for package in planned:
        templates = templates or Templates(custom)
        yield OutputPackage(
            package.name,
            _texts(package.files, templates),
            package.interfaces,
            package.source,
            _texts(package.beside, templates),
            _texts(package.once, templates),
        )


def _texts(files: Mapping[str, Artifact | OutputFile], templates: Templates) -> dict[str, str]:
    return {
        path: file.text if isinstance(file, OutputFile) else templates.render(file).text
        for path, file in files.items()
    }


class _Planning:
    """Plans the packages of a run."""

    def __init__(self, request: Request, resolved: ResolvedInput, up_to_date: UpToDate) -> None:
        self._request = request
        self._custom = request.custom
        self._resolved = resolved
        self._up_to_date = up_to_date
        self._facts = Facts(resolved.registry)
        self._sources = {package.name: request.source_of(package) for package in resolved.packages}

    def package(self, target: Target) -> PlannedPackage:
        """The files of a package."""
        ensured: tuple[str, ...] = ()
        names: list[str] = []
        files: list[Artifact | OutputFile] = []
        users: list[Artifact] = []
        if self._custom.distributions is not None:
            from ifgen.generator_py.outputs import installable

            if installable.is_installable(target.name):
                ensured = installable.from_runtime(target.interfaces, target.nodes, self._resolved.registries)
                files += self._for_pip(target, self._custom.distributions)
        if target.interfaces is not None:
            files += self._of_interfaces(target, target.interfaces, ensured)
            names += (f"{interface.folder}/{interface.name}" for interface in target.interfaces.interfaces)
        if target.nodes is not None:
            from ifgen.generator_py.nodes.package import plan_nodes, plan_users_files

            files += plan_nodes(target.nodes, target.interfaces, ensured, self._custom.requirements)
            users += plan_users_files(target.nodes)  # they are the user's once they are written
            if self._custom.tests and self._resolved.nodes is not None:
                files += plan_node_tests(target.nodes, self._resolved.nodes.registry)
                users += plan_users_tests(target.nodes, self._resolved.nodes.registry)
            names += (f"{NODE_FOLDER}/{node.name}" for node in target.nodes.nodes)
        return PlannedPackage(
            target.name,
            {file.path: file for file in files},
            tuple(sorted(names)),
            self._sources.get(target.name),
            once={file.path: file for file in users},
        )

    def _for_pip(self, target: Target, distributions: Distributions) -> Iterator[Artifact | OutputFile]:
        """The files that make a package installable by pip."""
        from ifgen.generator_py.outputs.installable import definitions, plan_project

        resolved = self._resolved
        root = next((package.root for package in resolved.packages if package.name == target.name), None)
        said = (package_xml.texts(root) if root else None) or {}
        ours = {target.name for target in resolved.targets} | (self._request.previous.keys() - {ROOT})
        yield plan_project(
            target.name, target.interfaces, target.nodes, said, distributions, self._custom.requirements, ours
        )
        for path, text in definitions(target.interfaces).items() if target.interfaces else ():
            yield OutputFile(_inner(target) + path, text)

    def _of_interfaces(
        self, target: Target, package: InterfacePackage, ensured: tuple[str, ...]
    ) -> Iterator[Artifact | OutputFile]:
        for artifact in plan_shared(package, ensured):
            yield replace(artifact, path=_inner(target) + artifact.path)
        for interface in package.interfaces:
            path = _inner(target) + module_path(interface)
            text = self._up_to_date.module(interface, self._resolved.registry, path)
            if text is not None:
                yield OutputFile(path, text)
            else:
                yield replace(plan_interface(interface, self._facts), path=path)
        if self._custom.tests:
            yield from plan_interface_tests(package, self._resolved.registry)


def _inner(target: Target) -> str:
    """The folder from which Python imports interfaces, in the folder of their package."""
    return "" if target.nodes is None else f"{target.name}/"


class _Outputs:
    """The outputs of `[tool.ifgen.outputs]`, planned for all packages of a run.

    Raises InputError for outputs that cannot be.
    """

    def __init__(self, custom: Customization, resolved: ResolvedInput) -> None:
        from ifgen.generator_py.outputs.plan import plan_outputs  # of use to few
        from ifgen.pipeline.model import build_model

        import_folders = {target.name: target.import_folder for target in resolved.targets if target.nodes}
        model = build_model(resolved).model
        packages = [package for package in model.packages if package.generate]
        variables: dict[str, object] = {"model": model, "options": dict[str, object]()}
        self._planned = plan_outputs(
            custom.outputs, packages, import_folders, variables, partial=custom.partial
        )

    def added_to(self, package: PlannedPackage) -> PlannedPackage:
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

    def of_run(self) -> dict[str, Artifact]:
        """The outputs of the whole run, by their paths."""
        return {p.artifact.path: p.artifact for p in self._planned if p.package is None}


def _taken(planned: PlannedOutput) -> Diagnostic:
    output = planned.output
    message = f"output '{output.name}' cannot be made: ifgen writes its own file at '{planned.artifact.path}'"
    return Diagnostic(
        "same-path", message, output.label("path"), help="replace the template of that file, or choose a path"
    )

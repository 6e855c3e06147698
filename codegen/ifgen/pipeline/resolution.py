"""From the packages of a run to what they mean: a job."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from ifgen.config.ros_distro import refused
from ifgen.definition.interfaces import Registry
from ifgen.definition.problems import one_for_each_cause
from ifgen.definition.resolve import resolve as resolve_interfaces
from ifgen.diagnostics import Diagnostic, InputError
from ifgen.pipeline.job import Job, Target
from ifgen.pipeline.values import Inputs
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath, WithDeps

if TYPE_CHECKING:
    from ifgen.nodl.model import Nodes


def resolve(inputs: Inputs) -> Job:
    """Parse and resolve everything. Raises InputError with all that is wrong."""
    packages, search, with_deps = inputs.packages, inputs.search, inputs.with_deps
    problems: list[Diagnostic] = []
    nodes = None
    if any(package.nodes for package in packages):
        from ifgen.nodl.load import load  # with a YAML parser, which interfaces do without

        try:
            nodes = load(packages, search)
        except InputError as error:
            problems += error.diagnostics
    with_interfaces = [package for package in packages if package.has_interfaces]
    if with_deps and nodes is not None:
        with_interfaces += _needed_by(nodes, with_interfaces, search, with_deps)
    try:
        registry = resolve_interfaces(with_interfaces, search, with_deps)
    except InputError as error:
        problems += error.diagnostics
        raise InputError(one_for_each_cause(dict.fromkeys(problems))) from None
    problems += refused(registry.warnings, inputs.custom.ros_distro)
    if problems:
        raise InputError(problems)
    return Job(packages, registry, nodes, tuple(_targets(registry, nodes, search, with_deps)), inputs.output)


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
        package = search.package(name)
        if package is not None and search.comes_along(name, with_deps):
            yield package

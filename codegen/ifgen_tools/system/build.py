"""A system from launch files and documents: what starts, under which names, and whom it would meet."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ifgen.config.settings import settle
from ifgen.definition.interfaces import Registry
from ifgen.diagnostics import Diagnostic, Label
from ifgen.nodl.model import Endpoint as Declared
from ifgen.nodl.model import NodeDescription
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

from ifgen_tools.launching.commands import activate
from ifgen_tools.system.documents import Documents
from ifgen_tools.system.model import Command, Endpoint, NodeInstance, NodeKind, Parameter, Remap, System
from ifgen_tools.system.parameters import ParameterFiles, given

if TYPE_CHECKING:
    from ifgen_tools.system.evaluation import Launched, LaunchedNode

# Late imports: `launch` is found once the transport has been chosen.

_KINDS: Mapping[str, NodeKind] = {
    "component_container": "container",
    "component_container_isolated": "container",
    "component_container_mt": "container",
    "static_transform_publisher": "transforms",
}
"""Programs that need no document."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Request:
    """The files to build a system from.

    `arguments` are those of the launch files, `packages` the folders with documents (default: those in
    [tool.ifgen]), `parameter_files` what every node gets on top.
    """

    launch_files: tuple[Path, ...]
    arguments: Mapping[str, str]
    packages: tuple[Path, ...] = ()
    include: tuple[Path, ...] = ()
    parameter_files: tuple[Path, ...] = ()
    transport: Literal["local", "rclpy", "auto"] = "auto"
    with_python: bool = True


@dataclass(frozen=True, slots=True)
class Built:
    """A system, the definitions of its interfaces, and what was wrong with the files that it is made of."""

    system: System
    registry: Registry
    findings: tuple[Diagnostic, ...] = ()


def build(request: Request) -> Built:
    """Evaluate launch files, and instantiate the document of each node. Raises InputError, ToolError.

    InputError is about launch files that cannot be evaluated; what is wrong with documents and parameter
    files is among the findings.
    """
    settings = settle(request.packages, None, request.include)
    packages = find_packages(settings.paths) if settings.paths else ()
    documents = Documents(SearchPath(packages, settings.include))
    launched = _evaluate(request, settings.output)
    files = ParameterFiles()
    nodes = [_instance(each, documents, files, request) for each in launched.nodes]
    types = {endpoint.type_name for node in nodes for endpoint in node.endpoints}
    hashes, registry = documents.hashes(types)
    managed = launched.managed
    system = System(
        tuple(_finished(node, hashes, managed, documents) for node in nodes),
        launched.commands,
        files.sections(),
    )
    return Built(system, registry, (*dict.fromkeys(documents.findings), *files.findings))


def full_name(name: str, node: str) -> str:
    """The full name of what a node calls `name`: within its namespace, or with `~` within its own name."""
    if name.startswith("~"):
        return f"{node}{name[1:]}"
    return name if name.startswith("/") else f"{node.rpartition('/')[0]}/{name}"


def remap_for(expanded: str, node: str, remaps: Iterable[Remap]) -> Remap | None:
    """The first remapping that is for this name of a node, as ROS chooses it; None if there is none."""
    for remap in remaps:
        prefix, colon, old = remap.old.rpartition(":")
        if prefix in {"rostopic", "rosservice"} or not colon:
            old = old.removeprefix("//") if prefix else old
        elif prefix != node.rpartition("/")[2]:
            continue
        if full_name(old, node) == expanded:
            return remap
    return None


def instantiate(
    description: NodeDescription, name: str, remaps: Sequence[Remap], documents: Documents
) -> tuple[Endpoint, ...]:
    """The endpoints of a described node that is started under this full name."""
    own = (*description.endpoints, *description.inherited.endpoints)
    names = {(each.category, full_name(each.name, name)) for each in own}
    framework = (
        each
        for each in (*description.reserved.endpoints, *documents.framework(description).endpoints)
        if (each.category, full_name(each.name, name)) not in names
    )
    terms = dict(description.terms)
    inherited = {id(each) for each in description.inherited.endpoints}

    def endpoint(declared: Declared, is_of_framework: bool) -> Endpoint:
        expanded = full_name(declared.name, name)
        remap = remap_for(expanded, name, remaps)
        return Endpoint(
            node=name,
            category=declared.category,
            written=declared.name,
            expanded=expanded,
            name=full_name(remap.new, name) if remap else expanded,
            type_name=declared.type_name,
            qos=declared.qos,
            terms=terms.get(declared.name),
            is_of_framework=is_of_framework,
            remap=remap,
            span=declared.span,
        )

    found = [endpoint(each, id(each) in inherited) for each in own]
    return (*found, *(endpoint(each, True) for each in framework))


def _evaluate(request: Request, output: Path) -> Launched:
    chosen = activate(request.transport, output)
    from ifgen_tools.launching.packages import UserPackages
    from ifgen_tools.system.evaluation import Evaluation, Launched, PackagesWithoutPython

    kind = UserPackages if request.with_python else PackagesWithoutPython
    nodes: list[LaunchedNode] = []
    commands: list[Command] = []
    managed: set[str] = set()
    for path in request.launch_files:
        evaluation = Evaluation(kind(output, chosen), with_python=request.with_python)
        found = evaluation.evaluate(path, request.arguments)
        nodes += found.nodes
        commands += found.commands
        managed |= found.managed
    return Launched(tuple(nodes), tuple(commands), frozenset(managed))


def _instance(
    launched: LaunchedNode, documents: Documents, files: ParameterFiles, request: Request
) -> NodeInstance:
    description = documents.of(launched.package, launched.executable, launched.name)
    own_name = launched.name or (description.name if description else _stem(launched.executable))
    name = f"{launched.namespace.rstrip('/')}/{own_name}"
    return NodeInstance(
        name=name,
        package=launched.package,
        executable=launched.executable,
        kind=_KINDS.get(launched.executable, launched.kind),
        description=description,
        endpoints=instantiate(description, name, launched.remaps, documents) if description else (),
        parameters=tuple(_parameters(launched, name, files, request.parameter_files)),
        remaps=launched.remaps,
        arguments=launched.arguments,
        is_managed=launched.is_managed,
        problem=_problem(launched, documents),
        span=launched.span,
    )


def _problem(launched: LaunchedNode, documents: Documents) -> Diagnostic | None:
    """The reason why a node cannot be started, where that is a mistake.

    A package that is not here may be on the robot, unless its name is almost that of one that is.
    """
    if launched.missing is None or launched.kind == "container":
        return None
    is_package = "has no executable" not in launched.missing.message
    is_near = "did you mean" in launched.missing.help
    if is_package and (documents.knows_package(launched.package) or not is_near):
        return None
    if not is_package and launched.executable in documents.names(launched.package):
        return None
    rule = "system-no-package" if is_package else "system-no-executable"
    label = Label(launched.span) if launched.span else None
    return Diagnostic(rule, launched.missing.message, label, help=launched.missing.help or None)


def _stem(executable: str) -> str:
    return executable.rpartition("::")[2].removesuffix(".py")


def _parameters(
    launched: LaunchedNode, name: str, files: ParameterFiles, more: Sequence[Path]
) -> Iterator[Parameter]:
    from ifgen_tools.system.evaluation import GivenFile

    for each in launched.parameters:
        if isinstance(each, GivenFile):
            yield from files.values(each.path, name, each.span, each.text)
        else:
            yield from (given(key, value, each.span) for key, value in each.values.items())
    for path in more:
        yield from files.values(path, name)


def _finished(
    node: NodeInstance, hashes: Mapping[str, str], managed: frozenset[str], documents: Documents
) -> NodeInstance:
    """The node with the hashes of its types, and whether a transition manages it."""
    known = {**hashes, **(documents.locked(node.description) if node.description else {})}
    endpoints = tuple(replace(each, type_hash=known.get(each.type_name, "")) for each in node.endpoints)
    is_managed = node.is_managed or node.name.rpartition("/")[2] in managed
    return replace(node, endpoints=endpoints, is_managed=is_managed)

"""Parameter files (`node: {ros__parameters: {...}}`) against what nodes declare, without running them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Final

from ifgen.definition.explain import did_you_mean
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, shorten
from ifgen.nodl import names, validators, values
from ifgen.nodl.model import NodeDescription, Parameter
from ifgen.nodl.syntax import reader
from ifgen.nodl.syntax.tree import Key, MapNode, Node, shown, yaml_surprise
from ifgen.nodl.values import BadValue, spelled
from ifgen.reading.packages import node_name
from ifgen.reading.storage import read_source

_PARAMETERS: Final = "ros__parameters"
_MISSPELLED: Final = re.compile(r"_*ros_*param(eter)?s?_*", re.IGNORECASE)
_EXTENSIONS: Final = (".yaml", ".yml")


def is_parameter_file(path: Path) -> bool:
    """Whether a path can only stand for a parameter file: YAML, and no description of a node."""
    return path.suffix in _EXTENSIONS and node_name(path.name) is None and path.is_file()


def check(files: Iterable[Path], nodes: Sequence[NodeDescription]) -> list[Diagnostic]:
    """Everything in the files that these nodes refuse, or that is for none of them."""
    found: list[Diagnostic] = []
    for path in files:
        try:
            source = read_source(path)
        except InputError as error:
            found += error.diagnostics
            continue
        problems = FileProblems(source)
        try:
            root = reader.parse(source, problems)
        except reader.UnreadableError as error:
            found.append(error.diagnostic)
            continue
        _check_file(root, source, nodes, problems)
        found += (*problems.errors(), *problems.warnings())
    return found


def _check_file(
    root: Node | None, source: Source, nodes: Sequence[NodeDescription], problems: FileProblems
) -> None:
    parts = list(sections(root, "", problems))
    if not parts and not problems:
        problems.warning(_no_section, source)
    given: dict[str, set[str]] = {}
    for name, key, parameters in parts:
        addressed = [node for node in nodes if _is_for(name, node)]
        if not addressed:
            problems.warning(_unknown_node, key, name, nodes)
        for word, place, value in flat_entries(parameters, ""):
            declarations = [
                (node, parameter)
                for node in addressed
                for parameter in (*node.parameters, *node.inherited.parameters, *node.reserved.parameters)
                if parameter.name == word
            ]
            for node in addressed:
                given.setdefault(node.name, set()).add(word)
            if addressed and not declarations and not names.reserved_parameter(word):
                problems.error(_unknown_parameter, place, word, addressed)
            for _, parameter in declarations[:1] if len(addressed) == 1 else declarations:
                check_value(parameter, value, problems)
    for node in nodes:
        for parameter in node.parameters:
            if node.name in given and parameter.is_required and parameter.name not in given[node.name]:
                problems.warning(_missing, source, node, parameter)


def sections(node: Node | None, name: str, problems: FileProblems) -> Iterator[tuple[str, Key, MapNode]]:
    """The parts of a file: the name or pattern of nodes, its last word, and the parameters."""
    for key, value in node.entries if isinstance(node, MapNode) else ():
        if not isinstance(value, MapNode):
            problems.error(_no_map, key, value)
            continue
        if key.name != _PARAMETERS and _MISSPELLED.fullmatch(key.name):
            problems.error(_misspelled, key)
            continue
        whole = f"{name}/{key.name.strip('/')}"
        parameters = value.get(_PARAMETERS)
        if isinstance(parameters, MapNode):
            yield whole, key, parameters
        elif parameters is not None:
            problems.error(_no_map, key, parameters)
        others = tuple((k, v) for k, v in value.entries if k.name != _PARAMETERS)
        yield from sections(MapNode(others, value.span), whole, problems)


def _is_for(name: str, node: NodeDescription) -> bool:
    """Whether a section is for a node, in whatever namespace that is started."""
    last = name.rpartition("/")[2]
    return last == "**" or fnmatchcase(node.name, last)


def flat_entries(node: MapNode, group: str) -> Iterator[tuple[str, Key, Node]]:
    """The parameters with their whole names, the keys where they stand, and their values."""
    for key, value in node.entries:
        name = f"{group}{key.name}"
        if isinstance(value, MapNode):
            yield from flat_entries(value, f"{name}.")
        else:
            yield name, key, value


def check_value(parameter: Parameter, node: Node, problems: FileProblems) -> None:
    """Report a value that a parameter cannot have."""
    if parameter.type.base == "none":
        return
    value = values.file_value(node, parameter.type)
    if isinstance(value, BadValue):
        problems.error(_wrong_value, value, parameter)
        return
    for validator in parameter.validators:
        if not validators.passes(value, validator):
            arguments = ", ".join(map(str, validator.arguments))
            problems.error(
                _rejected, node, parameter, f"{validator.name} {arguments}".rstrip(), validator.span
            )


def _no_section(source: Source) -> Diagnostic:
    """Say that a file has no parameters."""
    return Diagnostic(
        "unknown-node",
        "this file sets no parameters",
        Label(Span(source, 0, 0)),
        help="write `my_node: {ros__parameters: {my_parameter: value}}`",
        severity="warning",
    )


def _misspelled(key: Key) -> Diagnostic:
    """Say that parameters are below another word than ROS looks for."""
    return Diagnostic(
        "unknown-key",
        f"ROS takes `{shorten(key.name)}` for the name of a node",
        Label(key.span),
        help=f"write `{_PARAMETERS}`, with two underscores",
    )


def _no_map(key: Key, node: Node) -> Diagnostic:
    """Say that there are no parameters below a name."""
    return Diagnostic(
        "wrong-value",
        f"`{shorten(key.name)}` must be a map with the key `{_PARAMETERS}`",
        Label(node.span, f"this is {shown(node)}"),
    )


def _unknown_node(key: Key, name: str, nodes: Sequence[NodeDescription]) -> Diagnostic:
    """Say that parameters are for nobody."""
    known = [node.name for node in nodes]
    last = name.rpartition("/")[2]
    return Diagnostic(
        "unknown-node",
        f"no description is of a node '{shorten(last)}'",
        Label(key.span),
        help=did_you_mean(last, known) or "name the folder of its package with -I DIR",
        severity="warning",
    )


def _unknown_parameter(key: Key, name: str, nodes: Sequence[NodeDescription]) -> Diagnostic:
    """Say that no node declares a parameter."""
    known = [parameter.name for node in nodes for parameter in node.parameters]
    who = f"the node '{nodes[0].name}' has" if len(nodes) == 1 else "none of these nodes has"
    return Diagnostic(
        "unknown-parameter",
        f"{who} no parameter `{shorten(name)}`"
        if len(nodes) == 1
        else f"{who} a parameter `{shorten(name)}`",
        Label(key.span),
        help=did_you_mean(name, known) or (f"it has {shorten(', '.join(known), 200)}" if known else None),
    )


def _wrong_value(problem: BadValue, parameter: Parameter) -> Diagnostic:
    """Say that a value is not of the type that the node declares."""
    return Diagnostic(
        "wrong-value",
        f"`{shorten(parameter.name)}`, of type `{spelled(parameter.type)}`, must be {problem.expected}",
        Label(problem.node.span, f"this is {shown(values.read(problem.node))}"),
        help=yaml_surprise(problem.node, problem.expected),
    )


def _rejected(node: Node, parameter: Parameter, rule: str, because: Span | None) -> Diagnostic:
    """Say that the node refuses a value."""
    return Diagnostic(
        "rejected-value",
        f"the node refuses this value of `{shorten(parameter.name)}`: `{shorten(rule)}`",
        Label(node.span),
        (Label(because, "because of this"),) if because else (),
        "the node could not start: change one of the two",
    )


def _missing(source: Source, node: NodeDescription, parameter: Parameter) -> Diagnostic:
    """Say that a file leaves out what has no default."""
    return Diagnostic(
        "missing-value",
        f"the node '{node.name}' needs a value for `{shorten(parameter.name)}`, which has no default",
        Label(Span(source, 0, 0)),
        (Label(parameter.span, "declared here"),) if parameter.span else (),
        "set it here, or where the node is started",
        severity="warning",
    )

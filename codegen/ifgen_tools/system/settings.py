"""Rules about parameters: unknown ones, values that a node refuses, missing ones, and files for nobody."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ifgen.diagnostics import Diagnostic, Span, shorten
from ifgen.nodl import names, validators, values
from ifgen.nodl.model import NodeDescription
from ifgen.nodl.model import Parameter as Declared
from ifgen.nodl.syntax.tree import shown, yaml_surprise
from ifgen.nodl.values import BadValue, spelled

from ifgen_tools.system.model import NodeInstance, Parameter
from ifgen_tools.system.parameters import matches
from ifgen_tools.system.starting import set_later
from ifgen_tools.system.view import View, at, finding, nearest, suggestion


def unknown(view: View) -> Iterator[Diagnostic]:
    """Values for parameters that a node does not declare."""
    for node, description in view.described:
        known = _declared(description)
        for given in _that_count(node):
            if given.name in known or names.reserved_parameter(given.name) or _is_for_all(given):
                continue
            yield _unknown(node, given.name, given.span, known)


def wrong(view: View) -> Iterator[Diagnostic]:
    """Values of another type, and values that a validator refuses."""
    for node, description in view.described:
        known = _declared(description)
        for given in _that_count(node):
            declared = known.get(given.name)
            if declared is None or given.value is None or declared.type.base == "none":
                continue
            value = values.file_value(given.value, declared.type)
            if isinstance(value, BadValue):
                yield _wrong_type(node, given, declared, value)
                continue
            for validator in declared.validators:
                if not validators.passes(value, validator):
                    rule = f"{validator.name} {', '.join(map(str, validator.arguments))}".rstrip()
                    yield finding(
                        rule="system-value-rule",
                        message=f"{node.name} refuses this value of `{shorten(given.name)}`: "
                        f"`{shorten(rule)}`",
                        labels=(at(given.value.span), at(validator.span or declared.span, "by this")),
                        help="the node could not start: change one of the two",
                    )


def missing(view: View) -> Iterator[Diagnostic]:
    """Parameters without a default that nothing sets."""
    for node, description in view.described:
        for declared in description.parameters:
            if declared.is_required and node.value(declared.name) is None and node.kind != "running":
                close = nearest(declared.name, (each.name for each in node.parameters))
                yield finding(
                    rule="system-no-value",
                    message=f"{node.name} needs a value for `{shorten(declared.name)}`, and nothing sets it",
                    labels=(at(node.span, "started here"), at(declared.span, "without a default")),
                    help=f"did you mean it by `{close}`?" if close else "set it where the node is started",
                )


def for_nobody(view: View) -> Iterator[Diagnostic]:
    """Parts of parameter files that are for no node which gets the file."""
    for section in view.system.sections:
        if any(matches(section.pattern, node) for node in section.receivers):
            continue
        near = suggestion(section.pattern, section.receivers)
        near = near or _elsewhere(section.pattern, section.receivers)
        if view.is_open and near is None and not view.complete:
            continue
        yield finding(
            rule="system-no-receiver",
            message=f"no node that gets this file is `{section.pattern}`",
            labels=(at(section.span, "for nobody"), at(_start_of(view, section.receivers), "gets the file")),
            help=near,
            severity="warning",
        )


def read_only(view: View) -> Iterator[Diagnostic]:
    """Parameters that a launch file sets while the node runs, and that cannot change."""
    for command in view.system.commands:
        change = set_later(command)
        node = view.nodes.get(f"/{change[0].lstrip('/')}") if change else None
        if change is None or node is None or node.description is None:
            continue
        declared = _declared(node.description).get(change[1])
        if declared is not None and declared.read_only:
            yield finding(
                rule="system-read-only",
                message=f"`{change[1]}` of {node.name} cannot change while the node runs",
                labels=(at(command.span), at(declared.span, "read-only")),
                help="set it where the node is started",
                severity="warning",
            )
        elif declared is None and not names.reserved_parameter(change[1]):
            yield _unknown(node, change[1], command.span, _declared(node.description))


def _unknown(node: NodeInstance, name: str, span: Span | None, known: Mapping[str, Declared]) -> Diagnostic:
    near = nearest(name, known)
    listed = f"it has {shorten(', '.join(known), 200)}" if known else "it has none"
    return finding(
        rule="system-no-parameter",
        message=f"{node.name} has no parameter `{shorten(name)}`",
        labels=(at(span), at(known[near].span, "not this?") if near else None),
        help=suggestion(name, known) or listed,
    )


def _wrong_type(node: NodeInstance, given: Parameter, declared: Declared, value: BadValue) -> Diagnostic:
    return finding(
        rule="system-value-type",
        message=f"`{shorten(given.name)}` of {node.name}, of type `{spelled(declared.type)}`, "
        f"must be {value.expected}",
        labels=(
            at(value.node.span, f"this is {shown(values.read(value.node))}"),
            at(declared.span, "declared here"),
        ),
        help=yaml_surprise(value.node, value.expected),
    )


def _that_count(node: NodeInstance) -> Iterator[Parameter]:
    """The parameters of a node, of each name the last one."""
    yield from {each.name: each for each in node.parameters}.values()


def _is_for_all(given: Parameter) -> bool:
    """Whether a value is for any node, of which some declare the parameter."""
    return given.section.endswith("*")


def _declared(description: NodeDescription) -> dict[str, Declared]:
    found = (*description.parameters, *description.inherited.parameters, *description.reserved.parameters)
    return {each.name: each for each in found}


def _elsewhere(pattern: str, nodes: tuple[str, ...]) -> str | None:
    """A hint at the node of this name in another namespace."""
    last = pattern.rpartition("/")[2]
    found = next((node for node in nodes if node.rpartition("/")[2] == last), None)
    return f"the node is `{found}`: write this, or `/**/{last}`" if found else None


def _start_of(view: View, nodes: tuple[str, ...]) -> Span | None:
    node = view.nodes.get(nodes[0]) if len(nodes) == 1 else None
    return node.span if node else None

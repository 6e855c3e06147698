"""The parameters of a document: names, types, defaults and validators."""

from __future__ import annotations

from typing import Final

from ifgen.definition.problems import FileProblems
from ifgen.nodl import explain_parameters as explain
from ifgen.nodl import names, validators, values
from ifgen.nodl.endpoints import invalid_name
from ifgen.nodl.model import Parameter, ParameterType, ParameterValue, Validator
from ifgen.nodl.syntax import shape
from ifgen.nodl.syntax.tree import Key, MapNode, Node
from ifgen.nodl.values import BadValue

KEYS: Final = (
    "type",
    "default_value",
    "description",
    "read_only",
    "additional_constraints",
    "validation",
)


def read(document: MapNode, problems: FileProblems) -> list[Parameter]:
    """The parameters of a document, without those that have no usable name or type."""
    node = shape.entries(document, "parameters", "a map from names to parameters", problems)
    found = (_parameter(key, value, problems) for key, value in (node.entries if node else ()))
    return [parameter for parameter in found if parameter is not None]


def _parameter(key: Key, node: Node, problems: FileProblems) -> Parameter | None:
    problem = names.parameter_name_problem(key.name)
    if problem:
        problems.error(invalid_name, key.name, key.span, problem)
    elif names.reserved_parameter(key.name):
        problems.error(explain.reserved, key.name, key.span)
    if inner := _first_inside(node):
        problems.error(explain.nested_group, key, inner)
        return None
    fields = shape.table(node, "a parameter", KEYS, ("type",), problems)
    if fields is None:
        return None
    description = shape.text(fields, "description", problems) or ""
    read_only = shape.flag(fields, "read_only", problems)
    constraints = shape.text(fields, "additional_constraints", problems) or ""
    type_ = _type(fields, problems)
    if type_ is None:
        return None
    checks = _validators(fields, type_, problems)
    default = _default(fields, type_, checks, problems)
    return Parameter(key.name, type_, default, description, read_only, constraints, checks, key.span)


def _first_inside(node: Node) -> Key | None:
    """The first parameter in what is no parameter, but a group of them; None if it is no group."""
    if not isinstance(node, MapNode) or node.get("type") is not None:
        return None
    inside = (key for key, value in node.entries if isinstance(value, MapNode) and key.name not in KEYS)
    return next(inside, None)


def _type(fields: MapNode, problems: FileProblems) -> ParameterType | None:
    text = shape.text(fields, "type", problems)
    node = fields.get("type")
    if text is None or node is None:
        return None
    type_ = values.parameter_type(text)
    if type_ is None:
        problems.error(explain.unknown_type, text, node.span)
    return type_


def _validators(fields: MapNode, type_: ParameterType, problems: FileProblems) -> tuple[Validator, ...]:
    node = shape.entries(fields, "validation", "a map from validators to their arguments", problems)
    return validators.read(node, type_, problems) if node else ()


def _default(
    fields: MapNode, type_: ParameterType, checks: tuple[Validator, ...], problems: FileProblems
) -> ParameterValue | None:
    node = fields.get("default_value")
    if node is None:
        return None
    if type_.base == "none":
        problems.error(explain.default_of_nothing, node)
        return None
    value = values.value(node, type_)
    if isinstance(value, BadValue):
        problems.error(explain.wrong_default, value, type_)
        return None
    for validator in checks:
        if not validators.passes(value, validator):
            problems.error(explain.rejected_default, node, validator)
    return value

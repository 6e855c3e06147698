"""Explanations of mistakes in a parameter: its type, its default, its validators."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from ifgen.definition.explain import did_you_mean
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl.model import ParameterType, Validator
from ifgen.nodl.syntax.explain import yaml_surprise
from ifgen.nodl.syntax.tree import Key, Node, shown
from ifgen.nodl.values import ARRAYS, FIXED, SCALARS, BadValue, spelled

_FOREIGN_TYPES: Final = {
    "float": "double",
    "float64": "double",
    "float32": "double",
    "number": "double",
    "boolean": "bool",
    "integer": "int",
    "int64": "int",
    "str": "string",
    "text": "string",
    "list": "double_array` or `string_array",
    "bytes": "byte_array",
    "bool_array_fixed": "bool_array` with the validator `fixed_size",
}
_ON_SCALARS: Final = {
    "lower_element_bounds": "gt_eq",
    "upper_element_bounds": "lt_eq",
    "element_bounds": "bounds",
    "subset_of": "one_of",
}
_ON_ARRAYS: Final = {
    "gt_eq": "lower_element_bounds",
    "lt_eq": "upper_element_bounds",
    "bounds": "element_bounds",
    "one_of": "subset_of",
}


def unknown_type(text: str, span: Span) -> Diagnostic:
    """Say that there is no such type of parameters."""
    known = [*SCALARS, *ARRAYS, *(f"{name}_N" for name in FIXED)]
    base = text.rstrip("0123456789").rstrip("_")
    if base in _FOREIGN_TYPES:
        hint = f"write `{_FOREIGN_TYPES[base]}`"
    else:
        array = f"{_FOREIGN_TYPES.get(text[:-2], text[:-2])}_array"
        is_array = text.endswith("[]") and array in ARRAYS
        hint = (
            f"write `{array}`"
            if is_array
            else did_you_mean(text, known) or f"the types are {', '.join(known)}"
        )
    message = f"`{shorten(text)}` is not a type of parameters"
    return Diagnostic("invalid-parameter-type", message, Label(span), help=hint)


def nested_group(group: Key, inner: Key) -> Diagnostic:
    """Say that parameters are not grouped by maps."""
    name = f"{shorten(group.name)}.{shorten(inner.name)}"
    return Diagnostic(
        "unknown-key",
        f"parameters are not grouped by maps: a parameter has no key `{shorten(inner.name)}`",
        Label(inner.span, "unknown key"),
        help=f"write the whole name: `{name}: {{type: ...}}`",
    )


def reserved(name: str, span: Span) -> Diagnostic:
    """Say that rclpy declares a parameter itself."""
    return Diagnostic(
        "reserved-parameter",
        f"rclpy declares the parameter `{shorten(name)}` itself",
        Label(span),
        help="remove it: each node has it anyway",
    )


def wrong_default(problem: BadValue, type_: ParameterType) -> Diagnostic:
    """Say that a default is not of the parameter's type."""
    return Diagnostic(
        "wrong-default",
        f"a default of type `{spelled(type_)}` must be {problem.expected}",
        Label(problem.node.span, f"this is {shown(problem.node)}"),
        help=yaml_surprise(problem.node, problem.expected),
    )


def default_of_nothing(node: Node) -> Diagnostic:
    """Say that a parameter of type none has no default."""
    message = "a parameter of type `none` has no value, so it has no default"
    return Diagnostic("wrong-default", message, Label(node.span))


def rejected_default(node: Node, validator: Validator) -> Diagnostic:
    """Say that a default does not pass the parameter's own validator."""
    arguments = ", ".join(map(str, validator.arguments))
    said = f"`{validator.name}` allows {_allowed(validator.name, arguments)}"
    return Diagnostic(
        "rejected-default",
        f"the default does not pass its own validator: {said}",
        Label(node.span),
        (Label(validator.span, "because of this"),) if validator.span else (),
        "the node could not start: change one of the two",
    )


def _allowed(name: str, arguments: str) -> str:
    return {
        "bounds": f"[{arguments}]",
        "element_bounds": f"[{arguments}] for each element",
        "lt": f"less than {arguments}",
        "gt": f"more than {arguments}",
        "lt_eq": f"at most {arguments}",
        "gt_eq": f"at least {arguments}",
        "lower_element_bounds": f"at least {arguments} for each element",
        "upper_element_bounds": f"at most {arguments} for each element",
        "one_of": f"only {shorten(arguments)}",
        "subset_of": f"only {shorten(arguments)} as elements",
        "unique": "each element once",
        "not_empty": "any non-empty value",
        "fixed_size": f"only the size {arguments}",
        "size_gt": f"more than {arguments} elements or characters",
        "size_lt": f"less than {arguments} elements or characters",
    }[name]


def unknown_validator(key: Key, known: Iterable[str]) -> Diagnostic:
    """Say that there is no such validator."""
    known = list(known)
    name = key.name.removesuffix("<>")
    hint = did_you_mean(name, known) or (
        f"the validators are {', '.join(known)}; your own validator needs a namespace: `my::{shorten(name)}`"
    )
    return Diagnostic(
        "unknown-validator", f"there is no validator `{shorten(name)}`", Label(key.span), help=hint
    )


def duplicate_validator(key: Key, first: Key) -> Diagnostic:
    """Say that a validator is there twice."""
    return Diagnostic(
        "duplicate-key",
        f"the validator `{key.name.removesuffix('<>')}` is there twice, with and without `<>`",
        Label(key.span, "again"),
        (Label(first.span, "first here"),),
        "remove one of them",
    )


def unfit_validator(key: Key, name: str, type_: ParameterType, fitting: Iterable[str]) -> Diagnostic:
    """Say that a validator does not go with a type."""
    fitting = list(fitting)
    instead = (_ON_ARRAYS if type_.array else _ON_SCALARS).get(name)
    if instead in fitting:
        help = f"for a parameter of type `{spelled(type_)}` write `{instead}`"
    elif fitting:
        help = f"the validators that fit are {', '.join(fitting)}"
    else:
        help = "a parameter without a value cannot be validated"
    return Diagnostic(
        "unfit-validator",
        f"`{name}` does not fit the type `{spelled(type_)}`",
        Label(key.span),
        help=help,
    )


def invalid_arguments(name: str, problem: BadValue) -> Diagnostic:
    """Say that a validator takes other arguments."""
    return Diagnostic(
        "invalid-arguments",
        f"`{name}` takes {problem.expected}",
        Label(problem.node.span, f"this is {shown(problem.node)}"),
        help=yaml_surprise(problem.node, problem.expected),
    )


def empty_bounds(name: str, node: Node) -> Diagnostic:
    """Say that nothing lies between two bounds."""
    message = f"nothing passes `{name}`: the lower bound lies above the upper one"
    return Diagnostic("empty-bounds", message, Label(node.span), help="write [lower, upper]")


def mixed_bounds(key: Key, bounds: Key) -> Diagnostic:
    """Say that two validators that say the same do not go together."""
    return Diagnostic(
        "mixed-bounds",
        f"`{key.name}` cannot be used together with `{bounds.name}`",
        Label(key.span),
        (Label(bounds.span, "which sets both limits"),),
        "use one or the other: generate_parameter_library refuses both",
    )

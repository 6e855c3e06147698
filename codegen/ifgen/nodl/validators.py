"""Validators of parameters: their arguments, the types that they fit, and whether a value passes them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from ifgen.definition.explain import did_you_mean
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, shorten
from ifgen.nodl import values
from ifgen.nodl.model import ParameterType, ParameterValue, ScalarValue, Validator
from ifgen.nodl.syntax.tree import Foreign, Key, ListNode, MapNode, Node, ScalarNode, shown, yaml_surprise
from ifgen.nodl.values import BadValue, spelled

Arguments = Literal["none", "one", "pair", "size", "choices"]
Fits = Literal["number", "numbers", "scalar", "array", "sized"]

CUSTOM: Final = r"[a-zA-Z_][a-zA-Z0-9_]*(::[a-zA-Z_][a-zA-Z0-9_]*)+"
"""The form of the names of custom validators."""


@dataclass(frozen=True, slots=True)
class Rule:
    """The arguments of validators, the parameters that they fit, and the values that pass them.

    `passes` gets what is checked (the value, for `numbers` and subset_of each element, for `sized` and
    `unique` the whole) and the arguments.
    """

    arguments: Arguments
    fits: Fits
    passes: Callable[[ParameterValue, Sequence[ScalarValue]], bool]


def _compares(
    holds: Callable[[float, float], bool],
) -> Callable[[ParameterValue, Sequence[ScalarValue]], bool]:
    return lambda value, arguments: holds(_number(value), _number(arguments[0]))


def _each(
    passes: Callable[[ParameterValue, Sequence[ScalarValue]], bool],
) -> Callable[[ParameterValue, Sequence[ScalarValue]], bool]:
    return lambda value, arguments: all(passes(element, arguments) for element in elements(value))


def _within(value: ParameterValue, arguments: Sequence[ScalarValue]) -> bool:
    return _number(arguments[0]) <= _number(value) <= _number(arguments[1])


def _number(value: ParameterValue) -> float:
    assert isinstance(value, int | float)
    return value


def elements(value: ParameterValue) -> Sequence[ScalarValue]:
    """The elements of an array or of a byte array, the characters of a text."""
    assert isinstance(value, tuple | bytes | str)
    return value


_AT_LEAST: Final = _compares(lambda value, limit: value >= limit)
_AT_MOST: Final = _compares(lambda value, limit: value <= limit)

RULES: Final[Mapping[str, Rule]] = {
    "bounds": Rule("pair", "number", _within),
    "lt": Rule("one", "number", _compares(lambda value, limit: value < limit)),
    "gt": Rule("one", "number", _compares(lambda value, limit: value > limit)),
    "lt_eq": Rule("one", "number", _AT_MOST),
    "gt_eq": Rule("one", "number", _AT_LEAST),
    "element_bounds": Rule("pair", "numbers", _each(_within)),
    "lower_element_bounds": Rule("one", "numbers", _each(_AT_LEAST)),
    "upper_element_bounds": Rule("one", "numbers", _each(_AT_MOST)),
    "one_of": Rule("choices", "scalar", lambda value, choices: value in choices),
    "subset_of": Rule("choices", "array", lambda value, choices: all(e in choices for e in elements(value))),
    "unique": Rule("none", "array", lambda value, _: len(set(elements(value))) == len(elements(value))),
    "not_empty": Rule("none", "sized", lambda value, _: len(elements(value)) > 0),
    "fixed_size": Rule("size", "sized", lambda value, sizes: len(elements(value)) == sizes[0]),
    "size_gt": Rule("size", "sized", lambda value, sizes: len(elements(value)) > _number(sizes[0])),
    "size_lt": Rule("size", "sized", lambda value, sizes: len(elements(value)) < _number(sizes[0])),
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

_MIXED: Final = {
    "bounds": ("lt", "gt", "lt_eq", "gt_eq"),
    "element_bounds": ("lower_element_bounds", "upper_element_bounds"),
}


def read(node: MapNode, type_: ParameterType, problems: FileProblems) -> tuple[Validator, ...]:
    """The validators that a map under `validation` names, without those that are wrong."""
    found: dict[str, tuple[Validator, Key]] = {}
    for key, argument in node.entries:
        name = key.name.removesuffix("<>")
        wrong = _wrong_form(argument, RULES[name].arguments) if name in RULES else None
        if wrong is not None:
            problems.error(_invalid_arguments, name, wrong)
        elif name in found:
            problems.error(_duplicate_validator, key, found[name][1])
        elif name in RULES:
            validator = _built_in(key, name, argument, type_, problems)
            if validator is not None:
                found[name] = (validator, key)
        elif re.fullmatch(CUSTOM, key.name):
            arguments = _free_arguments(argument)
            if isinstance(arguments, BadValue):
                # NoDL takes lists with anything in them.
                is_list = isinstance(argument, ListNode)
                problems.error(_unfit_argument if is_list else _invalid_arguments, key.name, arguments)
            else:
                found[name] = (Validator(name, arguments, span=key.span), key)
        else:
            problems.error(_unknown_validator, key, RULES)
    for name, others in _MIXED.items():
        for other in others:
            if name in found and other in found:
                problems.error(_mixed_bounds, found[other][1], found[name][1])
    return tuple(validator for validator, _ in found.values())


def passes(value: ParameterValue, validator: Validator) -> bool:
    """Whether a value of the right type passes a validator; custom ones are for their function to judge."""
    rule = RULES.get(validator.name)
    return rule is None or rule.passes(value, validator.arguments)


def is_custom(validator: Validator) -> bool:
    """Whether a validator is the user's own, `ns::name`."""
    return validator.name not in RULES


def fits(rule: Rule, type_: ParameterType) -> bool:
    """Whether a validator can be used on parameters of a type."""
    is_number = type_.base in {"int", "double", "byte"}
    match rule.fits:
        case "number":
            return is_number and not type_.array
        case "numbers":
            return is_number and type_.array
        case "scalar":
            return not type_.array and type_.base != "none"
        case "array":
            return type_.array
        case "sized":
            return type_.array or type_.base == "string"


def _built_in(
    key: Key, name: str, argument: Node, type_: ParameterType, problems: FileProblems
) -> Validator | None:
    rule = RULES[name]
    if not fits(rule, type_):
        fitting = [other for other, known in RULES.items() if fits(known, type_)]
        problems.error(_unfit_validator, key, name, type_, fitting)
        return None
    # A byte array's elements are compared as the integers that they are.
    base = "int" if rule.arguments == "size" else type_.base
    arguments = _arguments(argument, rule.arguments, base)
    if isinstance(arguments, BadValue):
        problems.error(_unfit_argument, name, arguments)
        return None
    for item in _written_otherwise(argument):
        problems.warning(_text_for_others, name, item)
    if rule.arguments == "pair" and _number(arguments[0]) > _number(arguments[1]):
        problems.error(_empty_bounds, name, argument)
        return None
    return Validator(name, arguments, span=key.span)


def _wrong_form(node: Node, shape: Arguments) -> BadValue | None:
    """The part of an argument that NoDL refuses whatever type the parameter has."""
    items = node.items if isinstance(node, ListNode) else None
    match shape:
        case "none":
            is_nothing = isinstance(node, ScalarNode) and node.value is None
            return None if is_nothing or items == () else BadValue(node, "nothing, or an empty list")
        case "pair":
            if items is None or len(items) != 2:
                return BadValue(node, "[lower, upper], both inclusive")
        case "choices":
            inner = items[0] if items and len(items) == 1 else None
            is_list = isinstance(inner, ListNode) and inner.items
            return None if is_list else BadValue(node, "a list inside a list, [[a, b]]")
        case "one" | "size":
            if items is not None and len(items) != 1:
                return BadValue(node, "one number, x or [x]")
    for item in items or (node,):
        number = _any_number(item)
        if number is None or (shape == "size" and number % 1 != 0):
            return BadValue(item, "an integer" if shape == "size" else "a number")
        if shape == "size" and number < 0:
            return BadValue(node, "a size, 0 or more")
    return None


def _any_number(node: Node) -> float | None:
    read = values.read(node)
    value = read.value if isinstance(read, ScalarNode) else None
    return value if isinstance(value, int | float) and not isinstance(value, bool) else None


def _arguments(node: Node, shape: Arguments, base: str) -> tuple[ScalarValue, ...] | BadValue:
    """The arguments of a validator, in the right form, for a parameter or its elements of the type `base`."""
    items = node.items if isinstance(node, ListNode) else (node,)
    if shape == "none":
        return ()
    if shape == "choices":
        assert isinstance(items[0], ListNode)
        items = items[0].items
    return _scalars(items, base)


def _scalars(nodes: Sequence[Node], base: str) -> tuple[ScalarValue, ...] | BadValue:
    found: list[ScalarValue] = []
    for node in nodes:
        scalar = values.scalar(_whole(node) if base in {"int", "byte"} else node, base)
        if isinstance(scalar, BadValue):
            return scalar._replace(node=node)
        if isinstance(scalar, float) and math.isnan(scalar):
            return BadValue(node, "a number to compare with")
        found.append(scalar)
    return tuple(found)


def _written_otherwise(argument: Node) -> Iterator[ScalarNode]:
    """The numbers that are texts in YAML 1.1, which NoDL's schema does not take: `1e3`."""
    items = argument.items if isinstance(argument, ListNode) else (argument,)
    for item in items:
        if isinstance(item, ScalarNode) and isinstance(item.value, str):
            read = values.read(item)
            assert isinstance(read, ScalarNode)
            if isinstance(read.value, int | float) and not isinstance(read.value, bool):
                yield item


def _whole(node: Node) -> Node:
    """An integer for a number without a fraction, which for people is one: 5.0."""
    read = values.read(node)
    if isinstance(read, ScalarNode) and isinstance(read.value, float) and read.value.is_integer():
        return ScalarNode(int(read.value), read.span, read.plain)
    return node


def _free_arguments(node: Node) -> tuple[ScalarValue, ...] | BadValue:
    """The arguments of a custom validator: nothing, a scalar, or a list of them."""
    if isinstance(node, ScalarNode) and node.value is None:
        return ()
    found: list[ScalarValue] = []
    for item in node.items if isinstance(node, ListNode) else (node,):
        value = item.value if isinstance(item, ScalarNode) else None
        if value is None or isinstance(value, Foreign):
            return BadValue(item, "nothing, a number, a text, a boolean, or a list of these")
        found.append(value)
    return tuple(found)


def _unknown_validator(key: Key, known: Iterable[str]) -> Diagnostic:
    """Say that there is no such validator."""
    known = list(known)
    name = key.name.removesuffix("<>")
    hint = did_you_mean(name, known) or (
        f"the validators are {', '.join(known)}; your own validator needs a namespace: `my::{shorten(name)}`"
    )
    return Diagnostic(
        "unknown-validator", f"there is no validator `{shorten(name)}`", Label(key.span), help=hint
    )


def _duplicate_validator(key: Key, first: Key) -> Diagnostic:
    """Say that a validator is there twice."""
    return Diagnostic(
        "duplicate-validator",
        f"the validator `{key.name.removesuffix('<>')}` is there twice, with and without `<>`",
        Label(key.span, "again"),
        (Label(first.span, "first here"),),
        "remove one of them",
    )


def _unfit_validator(key: Key, name: str, type_: ParameterType, fitting: Iterable[str]) -> Diagnostic:
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


def _invalid_arguments(name: str, problem: BadValue) -> Diagnostic:
    """Say that a validator takes other arguments."""
    return Diagnostic(
        "invalid-arguments",
        f"`{name}` takes {problem.expected}",
        Label(problem.node.span, f"this is {shown(problem.node)}"),
        help=yaml_surprise(problem.node, problem.expected),
    )


def _unfit_argument(name: str, problem: BadValue) -> Diagnostic:
    """Say that a validator takes arguments of the parameter's type."""
    return Diagnostic(
        "unfit-argument",
        f"`{name}` takes {problem.expected}",
        Label(problem.node.span, f"this is {shown(problem.node)}"),
        help=yaml_surprise(problem.node, problem.expected),
    )


def _text_for_others(name: str, node: ScalarNode) -> Diagnostic:
    """Say that a number is a text in YAML 1.1."""
    return Diagnostic(
        "number-as-text",
        f"`ros2 nodl` takes this argument of `{name}` for a text, and refuses it",
        Label(node.span),
        help=yaml_surprise(node, "a number"),
        severity="warning",
    )


def _empty_bounds(name: str, node: Node) -> Diagnostic:
    """Say that nothing lies between two bounds."""
    message = f"nothing passes `{name}`: the lower bound lies above the upper one"
    return Diagnostic("empty-bounds", message, Label(node.span), help="write [lower, upper]")


def _mixed_bounds(key: Key, bounds: Key) -> Diagnostic:
    """Say that two validators that say the same do not go together."""
    return Diagnostic(
        "mixed-bounds",
        f"`{key.name}` cannot be used together with `{bounds.name}`",
        Label(key.span),
        (Label(bounds.span, "which sets both limits"),),
        "use one or the other: generate_parameter_library refuses both",
    )

"""The parameters of a document: names, types, defaults and validators."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from ifgen.definition.explain import did_you_mean
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span, shorten
from ifgen.nodl import names, validators, values
from ifgen.nodl.endpoints import invalid_name
from ifgen.nodl.model import Parameter, ParameterType, ParameterValue, Validator
from ifgen.nodl.syntax import tree
from ifgen.nodl.syntax.tree import Key, ListNode, MapNode, Node, ScalarNode, shown, yaml_surprise
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
    node = tree.entries(document, "parameters", "a map from names to parameters", problems)
    found = (_parameter(key, value, problems) for key, value in (node.entries if node else ()))
    return [parameter for parameter in found if parameter is not None]


def expanded(options: MapNode, declared: Sequence[Parameter], problems: FileProblems) -> Iterator[Parameter]:
    """The parameters of `codegen.ifgen.structs`: for each name of a map of structs, those of the struct.

    The shapes of the maps are checked with the other options.
    """
    structs = options.get("structs")
    for group, struct in structs.entries if isinstance(structs, MapNode) else ():
        fields, each = (struct.get("of"), struct.get("each")) if isinstance(struct, MapNode) else (None, None)
        if not isinstance(fields, MapNode) or each is None:
            continue
        for name, span in _names_of(each, declared, problems):
            for key, node in fields.entries:
                whole = Key(f"{group.name}.{name}.{key.name}", span or key.span)
                parameter = _parameter(whole, node, problems)
                if parameter is not None:
                    yield parameter


def _names_of(
    each: Node, declared: Sequence[Parameter], problems: FileProblems
) -> list[tuple[str, Span | None]]:
    """The names that a map of structs has: a list, or the default of a parameter."""
    if isinstance(each, ListNode):
        texts = ((item.value, item.span) for item in each.items if isinstance(item, ScalarNode))
        return [(text, span) for text, span in texts if isinstance(text, str)]
    text = each.value if isinstance(each, ScalarNode) else None
    found = next((parameter for parameter in declared if parameter.name == text), None)
    if found is None or found.type.base != "string" or not isinstance(found.default, tuple):
        if isinstance(text, str):
            problems.error(_no_names, text, each.span)
        return []
    return [(str(name), each.span) for name in found.default]


def _no_names(name: str, span: Span) -> Diagnostic:
    """Say that a parameter does not say which structs there are."""
    return Diagnostic(
        "invalid-option",
        f"`{shorten(name)}` is no parameter of type string_array with a default in this document",
        Label(span),
        help="name one, whose default has the names, or write a list of names",
    )


def _parameter(key: Key, node: Node, problems: FileProblems) -> Parameter | None:
    problem = names.parameter_name_problem(key.name)
    if problem:
        if names.nodl_allows_parameter(key.name):
            problems.error(invalid_name, key.name, key.span, problem, rule="unusable-name")
        else:
            problems.error(invalid_name, key.name, key.span, problem)
    if inner := _first_inside(node):
        problems.error(_nested_group, key, inner)
        return None
    fields = tree.table(node, "a parameter", KEYS, ("type",), problems)
    if fields is None:
        return None
    description = tree.text(fields, "description", problems) or ""
    read_only = tree.flag(fields, "read_only", problems)
    constraints = tree.text(fields, "additional_constraints", problems) or ""
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
    text = tree.text(fields, "type", problems)
    node = fields.get("type")
    if text is None or node is None:
        return None
    type_ = values.parameter_type(text)
    if type_ is None:
        problems.error(_unknown_type, text, node.span)
    elif (type_.fixed_size or 0) > values.MAX_FIXED_SIZE:
        problems.error(_too_long, text, node.span)
    return type_


def _validators(fields: MapNode, type_: ParameterType, problems: FileProblems) -> tuple[Validator, ...]:
    node = tree.entries(fields, "validation", "a map from validators to their arguments", problems)
    return validators.read(node, type_, problems) if node else ()


def _default(
    fields: MapNode, type_: ParameterType, checks: tuple[Validator, ...], problems: FileProblems
) -> ParameterValue | None:
    node = fields.get("default_value")
    if node is None:
        return None
    if type_.base == "none":
        problems.error(_default_of_nothing, node)
        return None
    value = values.value(node, type_)
    if isinstance(value, BadValue):
        problems.error(_wrong_default, value, type_)
        return None
    for validator in checks:
        if not validators.passes(value, validator):
            problems.error(_rejected_default, node, validator)
    return value


def _unknown_type(text: str, span: Span) -> Diagnostic:
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


def _too_long(text: str, span: Span) -> Diagnostic:
    """Say that no value is as long as a type allows."""
    message = f"`{text}` must be of {values.MAX_FIXED_SIZE} or less"
    return Diagnostic("too-large-number", message, Label(span))


def _nested_group(group: Key, inner: Key) -> Diagnostic:
    """Say that parameters are not grouped by maps."""
    name = f"{shorten(group.name)}.{shorten(inner.name)}"
    return Diagnostic(
        "unknown-key",
        f"parameters are not grouped by maps: a parameter has no key `{shorten(inner.name)}`",
        Label(inner.span, "unknown key"),
        help=f"write the whole name: `{name}: {{type: ...}}`",
    )


def _wrong_default(problem: BadValue, type_: ParameterType) -> Diagnostic:
    """Say that a default is not of the parameter's type. NoDL's schema looks at those of bytes alone."""
    return Diagnostic(
        "wrong-value" if type_.base == "byte" else "wrong-default",
        f"a default of type `{spelled(type_)}` must be {problem.expected}",
        Label(problem.node.span, f"this is {shown(problem.node)}"),
        help=yaml_surprise(problem.node, problem.expected),
    )


def _default_of_nothing(node: Node) -> Diagnostic:
    """Say that a parameter of type none has no default."""
    message = "a parameter of type `none` has no value, so it has no default"
    return Diagnostic("wrong-default", message, Label(node.span))


def _rejected_default(node: Node, validator: Validator) -> Diagnostic:
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

"""Names that IDL and rosidl_parser allow, and that no Python class can have side by side."""

from __future__ import annotations

import keyword
from collections.abc import Iterable

from ifgen.definition import names
from ifgen.definition.interfaces import Constant, Field
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span


def check(fields: Iterable[Field], constants: Iterable[Constant], problems: FileProblems) -> None:
    """Report names that are taken: by the class itself, by another field, or by a default value."""
    taken: dict[str, Span | None] = {"SLOT_TYPES": None}
    fields = tuple(fields)
    with_default = {field.name.upper() for field in fields if field.default_value is not None}
    for field in fields:
        needed = [names.attribute_name(field)]
        if field.name.upper() in with_default:  # the class looks for a default by that name
            needed.append(names.default_name(field))
        for name in needed:
            if name in taken:
                problems.error(_taken, "field", field.name, name, field.span, taken[name])
            taken.setdefault(name, field.span)
    taken["get_fields_and_field_types"] = None
    for constant in constants:
        if keyword.iskeyword(constant.name):
            problems.error(_keyword, constant)
        elif constant.name in taken:
            problems.error(
                _taken, "constant", constant.name, constant.name, constant.span, taken[constant.name]
            )


def _keyword(constant: Constant) -> Diagnostic:
    assert constant.span is not None
    message = f"no constant of a Python class can be called '{constant.name}'"
    return Diagnostic("keyword-name", message, Label(constant.span), help="rename the constant")


def _taken(what: str, shown: str, name: str, span: Span | None, other: Span | None) -> Diagnostic:
    assert span is not None
    attribute = f"`{name}`" if name == shown else f"`{name}` of '{shown}'"
    return Diagnostic(
        "name-clash",
        f"the {what} {attribute} has the name of something else in its Python class",
        Label(span),
        (Label(other, "this has it"),) if other else (),
        "rename one of them" if other else f"rename the {what}",
    )

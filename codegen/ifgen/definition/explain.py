"""What is wrong with a definition, in words that teach: built only once something is wrong."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Final

from ifgen.definition.escapes import BadValue
from ifgen.definition.spelling import PRIMITIVES, BadType
from ifgen.diagnostics import Diagnostic, Label, Source, Span
from ifgen.idl.explain import shorten

_FOREIGN_TYPES: Final = {
    "int": "int32",
    "uint": "uint32",
    "float": "float32` or `float64",
    "double": "float64",
    "str": "string",
    "boolean": "bool",
    "u8string": "string",
    "time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
}


def bad_type(problem: BadType, text: str, source: Source, start: int) -> Diagnostic:
    """Say why a type's text is no type."""
    span = Span(source, start + problem.start, start + problem.end)
    base = text.partition("[")[0]
    help = problem.help
    if base in _FOREIGN_TYPES:
        help = f"write `{_FOREIGN_TYPES[base]}`"
    elif help is None:
        help = did_you_mean(base, PRIMITIVES)
    return Diagnostic(problem.rule, problem.message, Label(span), help=help)


def field_name(name: str, span: Span) -> Diagnostic:
    """Say why a field cannot have this name."""
    return Diagnostic(
        "invalid-field-name",
        f"`{shorten(name)}` is not a valid field name",
        Label(span),
        help="start with a lower-case letter; then lower-case letters, digits and single underscores, none at the end",
    )


def constant_name(name: str, span: Span) -> Diagnostic:
    """Say why a constant cannot have this name."""
    return Diagnostic(
        "invalid-constant-name",
        f"`{shorten(name)}` is not a valid constant name",
        Label(span),
        help="start with an upper-case letter; then upper-case letters, digits and single underscores, none at the end",
    )


def constant_type(text: str, span: Span) -> Diagnostic:
    """Say that a constant must be of a primitive type."""
    return Diagnostic(
        "invalid-constant-type",
        f"a constant cannot be of type `{shorten(text)}`",
        Label(span),
        help="constants are numbers, booleans or strings without a bound",
    )


def duplicate(what: str, name: str, span: Span, first: Span | None) -> Diagnostic:
    """Say that two fields or two constants have the same name."""
    return Diagnostic(
        f"duplicate-{what}",
        f"{what} '{name}' is declared twice",
        Label(span, "declared again"),
        (Label(first, "first declared here"),) if first else (),
        "rename one of them",
    )


def bad_value(error: BadValue, type_text: str, span: Span) -> Diagnostic:
    """Say why a text is no value of its type."""
    shown = shorten(span.source.text[span.start : span.end])
    return Diagnostic(
        error.rule,
        f"`{shown}` is not a value of type `{type_text}`",
        Label(span, error.message),
        help=error.help,
    )


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """A hint at the known names that look most alike."""
    matches = difflib.get_close_matches(name[:100], list(known), n=3, cutoff=0.7)
    return f"did you mean {' or '.join(f'`{match}`' for match in matches)}?" if matches else None

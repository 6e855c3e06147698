"""The words and places that the diagnostics of all edits are made of."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from ifgen.definition.interfaces import Field
from ifgen.definition.spelling import spelled
from ifgen.definition.types import FieldType
from ifgen.diagnostics import Label, Span

Place: TypeAlias = tuple[Span | None, str]
"""A place in one version, and what to say of it."""


class Said(NamedTuple):
    """The rule and the message about an edit, and its places in both versions."""

    rule: str
    message: str
    new: Place = (None, "")
    old: Place = (None, "")


def label(span: Span | None, text: str) -> Label | None:
    """A label, if there is a place for it."""
    return None if span is None else Label(span, text)


def type_span(field: Field) -> Span | None:
    """The place of the whole type of a field, with its brackets; None for derived fields."""
    if field.type_span is not None or field.span is None:
        return field.type_span
    source = field.span.source
    line = field.span.start - field.span.column + 1
    words = source.text[line : field.span.start].split()
    if not words:
        return field.span
    start = source.text.rindex(words[-1], line, field.span.start)
    return Span(source, start, start + len(words[-1]))


def shown_type(old: FieldType, new: FieldType) -> tuple[str, str]:
    """Two types for a message."""
    return f"`{spelled(old)}`", f"`{spelled(new)}`"


def counted(number: int, noun: str) -> str:
    """The number with its noun: `1 file`, `2 files`."""
    return f"{number} {noun}{'' if number == 1 else 's'}"

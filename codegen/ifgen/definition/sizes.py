"""The limits that the wire sets to sizes and bounds, and to the number of values in a message."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from ifgen.definition.interfaces import Message
from ifgen.definition.problems import FileProblems
from ifgen.definition.references import references
from ifgen.definition.types import (
    Array,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
)
from ifgen.diagnostics import Diagnostic, Label, Span, shorten

LARGEST_SIZE: Final = 2**32 - 1
"""A length on the wire has 32 bits: that of a sequence or a text, and that of a message in bytes."""


def check_sizes(type_: FieldType, span: Span, problems: FileProblems) -> None:
    """Refuse sizes that no message can have."""
    if any(size > LARGEST_SIZE for size in _sizes(type_)):
        problems.error(_too_large, span)


def _too_large(span: Span) -> Diagnostic:
    return Diagnostic(
        "invalid-size",
        f"the size of `{shorten(span.source.text[span.start : span.end])}` is above {LARGEST_SIZE}",
        Label(span, "rosidl accepts it, but a length on the wire has 32 bits"),
        help="write a smaller size",
    )


def _sizes(type_: FieldType) -> list[int]:
    match type_:
        case Array(value_type=element, size=size):
            return [size, *_sizes(element)]
        case BoundedSequence(value_type=element, maximum_size=size):
            return [size, *_sizes(element)]
        case UnboundedSequence(value_type=element):
            return _sizes(element)
        case BoundedString(maximum_size=size) | BoundedWString(maximum_size=size):
            return [size]
        case _:
            return []


def check_totals(messages: Mapping[str, Message]) -> list[Diagnostic]:
    """Find the messages whose arrays, nested ones included, hold too many values. There are no cycles."""
    found: list[Diagnostic] = []
    values: dict[str, int] = {}
    for message in needed_first(messages):
        name = message.type_name
        counts = [value_count(field.type, values) for field in message.fields]
        values[name] = sum(counts)
        if values[name] > LARGEST_SIZE:
            values[name] = 0  # one error is enough for those that nest it
            largest = max(counts)
            span = message.fields[counts.index(largest)].span
            here = f"{largest} values of at least one byte; a message has at most {LARGEST_SIZE} bytes"
            label = Label(span, here) if span else None
            text = f"the arrays of {name} are too large to be sent"
            found.append(Diagnostic("invalid-size", text, label, help="make them smaller"))
    return found


def needed_first(messages: Mapping[str, Message]) -> Iterator[Message]:
    """Messages, each after those of its fields. There are no cycles; types that are missing do not count."""
    done: set[str] = set()
    pending = list(messages)
    while pending:
        message = messages[pending[-1]]
        names = {type_.type_name for _, type_ in references(message)}
        waiting = [name for name in names if name not in done and name in messages]
        if waiting:
            pending += waiting
        elif pending.pop() not in done:
            done.add(message.type_name)
            yield message


def value_count(type_: FieldType, known: Mapping[str, int]) -> int:
    """The number of values in a default field; `known` has that of messages."""
    if isinstance(type_, Array):
        return type_.size * value_count(type_.value_type, known)
    return known.get(type_.type_name, 0) if isinstance(type_, NamespacedType) else 1

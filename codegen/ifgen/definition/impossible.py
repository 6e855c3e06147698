"""Types that no code can hold: messages that contain themselves, and sizes beyond the numbers of the wire."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from ifgen.definition.interfaces import Field, Message
from ifgen.definition.problems import FileProblems
from ifgen.definition.references import references, type_span
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

_MAX_LINKS = 10
LARGEST_SIZE: Final = 2**32 - 1
"""A length on the wire has 32 bits: that of a sequence or a text, and that of a message in bytes."""


def check_cycles(messages: Mapping[str, Message]) -> list[Diagnostic]:
    """One finding for each circle of messages that a walk over all of them runs into."""
    found: list[Diagnostic] = []
    done: set[str] = set()
    for root in messages:
        if root not in done:
            found.extend(_describe(cycle) for cycle in _cycles_from(root, messages, done))
    return found


def _cycles_from(
    root: str, messages: Mapping[str, Message], done: set[str]
) -> Iterator[list[tuple[Message, Field]]]:
    """Walk depth first, on a stack of our own since chains may be long; yield the links of each circle."""
    path: list[tuple[Message, Field]] = []
    depth = {root: 0}
    pending = [(messages[root], references(messages[root]))]
    while pending:
        message, remaining = pending[-1]
        field, type_ = next(remaining, (None, None))
        if field is None or type_ is None:
            pending.pop()
            done.add(message.type_name)
            del depth[message.type_name]
            if path:
                path.pop()
            continue
        name = type_.type_name
        if name in depth:
            yield [*path[depth[name] :], (message, field)]
        elif name not in done and name in messages:
            depth[name] = len(pending)
            path.append((message, field))
            pending.append((messages[name], references(messages[name])))


def _describe(links: list[tuple[Message, Field]]) -> Diagnostic:
    first, *others = links
    labels = [_label(message, field) for message, field in (first, *others[: _MAX_LINKS - 1])]
    known = [label for label in labels if label is not None]
    circle = " -> ".join(message.type_name for message, _ in [*links[:_MAX_LINKS], first])
    return Diagnostic(
        "recursive-type",
        f"{first[0].type_name} contains itself",
        known[0] if known else None,
        tuple(known[1:]),
        f"the cycle is {circle}; messages cannot be recursive, not even through a sequence",
    )


def _label(message: Message, field: Field) -> Label | None:
    span = type_span(field)
    return Label(span, f"{message.type_name} holds this") if span else None


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

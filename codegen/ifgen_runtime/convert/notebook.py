"""Messages as tables in notebooks: a line for each field, in plain HTML without styles or scripts."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from itertools import islice
from reprlib import Repr
from typing import Any, NamedTuple

from ifgen_runtime.codec.encoding import type_name
from ifgen_runtime.field_types import Field, fields_of
from ifgen_runtime.message import generated_class

MAX_LINES = 60
"""The lines of a table. One more says that there are others."""

MAX_ELEMENTS = 9
"""The elements that are shown of a sequence of numbers or texts: a covariance of 3 x 3."""

_MAX_MESSAGES = 3
_MAX_FIELDS = 4  # of a message on one line: a quaternion
_INDENT = "&emsp;"  # styles do not survive everywhere that notebooks are shown

_short = Repr()
_short.maxstring = _short.maxother = 80


class Line(NamedTuple):
    """A line of the table, as plain text: how deep it is, the field, its value and its type."""

    depth: int
    name: str
    value: str = ""
    type: str = ""


def html_of(message: Any) -> str:
    """The message as a table of its fields. It never raises, whatever they hold."""
    lines = list(islice(_lines(message, 0), MAX_LINES + 1))
    if len(lines) > MAX_LINES:
        lines[MAX_LINES:] = [Line(0, "…")]
    head = "<tr><th>field</th><th>value</th><th>type</th></tr>"
    return (
        f"<table><caption>{escape(type_name(message.__class__))}</caption>"
        f"<thead>{head}</thead><tbody>{''.join(map(_row, lines))}</tbody></table>"
    )


def _row(line: Line) -> str:
    name, value, type_ = map(escape, line[1:])
    return f"<tr><td>{_INDENT * line.depth}{name}</td><td>{value}</td><td>{type_}</td></tr>"


def _lines(message: Any, depth: int) -> Iterator[Line]:
    cls = generated_class(message.__class__)
    types: dict[str, str] = cls._fields_and_field_types
    for field in fields_of(cls):
        line = Line(depth, field.name, type=types[field.name])
        yield from _field_lines(line, getattr(message, field.slot, None), field)


def _field_lines(line: Line, value: Any, field: Field) -> Iterator[Line]:
    if field.is_collection:
        yield from _collection_lines(line, value, field)
    elif not isinstance(field.type, type) or not isinstance(value, field.type):
        yield line._replace(value=_text(value))
    elif _is_small(field.type):
        fields = (f"{part.name}: {_text(getattr(value, part.slot, None))}" for part in fields_of(field.type))
        yield line._replace(value=", ".join(fields))
    else:
        yield line
        yield from _lines(value, line.depth + 1)


def _collection_lines(line: Line, value: Any, field: Field) -> Iterator[Line]:
    holds_messages = isinstance(field.type, type)
    count, first = 0, list[Any]()
    try:
        count = len(value)
        first.extend(islice(value, _MAX_MESSAGES if holds_messages else MAX_ELEMENTS))
    except Exception:  # a value that is no sequence
        yield line._replace(value=_text(value))
        return
    if not holds_messages:
        yield line._replace(value=_elements(first, count))
        return
    yield line._replace(value=_counted(count))
    for index, element in enumerate(first):
        part = Line(line.depth + 1, f"[{index}]")
        yield from _field_lines(part, element, Field(part.name, field.slot, field.type))
    if count > len(first):
        yield Line(line.depth + 1, "…")


def _is_small(cls: type[Any]) -> bool:
    """Whether a message has only a few fields that are single values: a point, a time, a quaternion."""
    fields = fields_of(cls)
    return len(fields) <= _MAX_FIELDS and not any(
        field.is_collection or isinstance(field.type, type) for field in fields
    )


def _elements(first: list[Any], count: int) -> str:
    texts = [*map(_text, first), *(["…"] if count > len(first) else [])]
    text = f"[{', '.join(texts)}]"
    return text if count == len(first) else f"{text} ({_counted(count)})"


def _counted(count: int) -> str:
    return "1 element" if count == 1 else f"{count} elements"


def _text(value: Any) -> str:
    try:
        number = value.item() if hasattr(value, "item") else value  # of numpy's
        return _short.repr(number)
    except Exception:  # a repr of somebody's
        return f"<{value.__class__.__name__}>"

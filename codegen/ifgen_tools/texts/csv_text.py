"""Messages as values with commas between them, as `ros2 topic echo --csv` prints them.

Texts with a comma, a quote or the end of a line are in quotes, which ros2 leaves out (RFC 4180).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ifgen_tools.texts.field_types import FieldType, field_types
from ifgen_tools.texts.yaml_text import Style, abbreviated, cut


def as_csv(message: Any, style: Style) -> str:
    """All values of a message, those of nested messages too, in the order of the definition."""
    types = field_types(type(message))
    return ",".join(_text(getattr(message, type_.attribute), style, type_) for type_ in types.values())


def _text(value: Any, style: Style, type_: FieldType | None = None) -> str:
    if isinstance(value, str):
        if style.no_str:
            return f"<string length: <{len(value)}>>"
        return _cell(cut(value, style))
    if isinstance(value, bytes):
        return _cell(str(value if _fits(value, style) else value[: style.longest] + b"..."))
    if hasattr(value, "get_fields_and_field_types"):
        return as_csv(value, style)
    if not hasattr(value, "__len__"):  # a number
        return str(value)
    if style.no_arr and type_ is not None:
        return _cell(abbreviated(len(value), type_))
    return ",".join(_elements(value, style))


def _cell(text: str) -> str:
    """A text as one cell of a row."""
    return '"' + text.replace('"', '""') + '"' if any(each in text for each in ',"\r\n') else text


def _elements(values: Any, style: Style) -> Iterator[str]:
    for value in values if _fits(values, style) else values[: style.longest]:
        yield _text(value, style)
    if not _fits(values, style):
        yield "..."


def _fits(value: Any, style: Style) -> bool:
    return style.longest is None or len(value) <= style.longest

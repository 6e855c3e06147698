"""The default values in a type description, which are Python's text of them: rosidl's own form."""

from __future__ import annotations

import ast
from typing import Final, cast

from ifgen.definition.described.values import Value, from_plain
from ifgen.definition.escapes import BadValue
from ifgen.definition.types import Array, BasicType, BoundedSequence, FieldType, UnboundedSequence

_LONGEST: Final = 2**20
_LONGEST_NUMBER: Final = 400


def default_value(text: str, type_: FieldType) -> Value:
    """The value that a text stands for in a field of this type. Raises BadValue."""
    if len(text) > _LONGEST:
        raise BadValue("it is too long")
    if not isinstance(type_, Array | BoundedSequence | UnboundedSequence):
        return from_plain(_item(text, type_), type_)
    if isinstance(type_.value_type, BasicType):
        inside = text.removeprefix("(").removesuffix(")").removesuffix(",")
        if text[:1] != "(" or text[-1:] != ")":
            raise BadValue("expected a tuple")
        element = type_.value_type
        return from_plain([_item(item.strip(), element) for item in inside.split(",") if inside], type_)
    try:
        values: object = ast.literal_eval(text)
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        raise BadValue("expected a tuple of strings") from None
    if not isinstance(values, tuple):
        raise BadValue("expected a tuple of strings")
    return from_plain(list(cast("tuple[object, ...]", values)), type_)


def _item(text: str, type_: FieldType) -> object:
    """The plain value of a text; strings are themselves."""
    if not isinstance(type_, BasicType):
        return text
    try:
        if len(text) > _LONGEST_NUMBER:
            raise ValueError
        match type_.typename:
            case "boolean":
                return {"True": True, "False": False}[text]
            case "float" | "double":
                return float(text)
            case _:
                return int(text)
    except (ValueError, KeyError):
        raise BadValue(f"expected a value of type {type_.typename}") from None

"""Values of constants and defaults as plain data: octets and characters as integers, arrays as lists."""

from __future__ import annotations

import ast
import math
from typing import Final, TypeAlias, cast

from ifgen.definition.interfaces import Plain, Scalar
from ifgen.definition.literals import INTEGER_RANGES, BadValue, check_count
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    ValueType,
    element_of,
)

Value: TypeAlias = Scalar | tuple[Scalar, ...]

_LARGEST_CHARACTER: Final = 255


def plain(value: Value, type_: FieldType) -> Plain | list[Plain]:
    """The plain form of a value of this type."""
    element = element_of(type_)
    if isinstance(value, tuple):
        return [_plain(item, element) for item in value]
    return _plain(value, element)


def _plain(value: Scalar, type_: ValueType) -> Plain:
    if isinstance(value, bytes):
        return value[0]
    return ord(value) if isinstance(value, str) and type_ == BasicType("char") else value


def from_plain(value: object, type_: FieldType) -> Value:
    """The value of this type whose plain form is `value`. Raises BadValue if there is none."""
    if not isinstance(type_, Array | BoundedSequence | UnboundedSequence):
        return _scalar(value, type_)
    if not isinstance(value, list):
        raise BadValue("expected a list of values")
    items = cast("list[object]", value)
    check_count(len(items), type_)
    return tuple([_scalar(item, type_.value_type) for item in items])


def _scalar(value: object, type_: ValueType) -> Scalar:
    if isinstance(type_, NamespacedType):
        raise BadValue("a field of a message type cannot have a default value")
    if not isinstance(type_, BasicType):
        if not isinstance(value, str) or "\0" in value:
            raise BadValue("expected a string without NUL")
        if isinstance(type_, BoundedString | BoundedWString) and len(value) > type_.maximum_size:
            raise BadValue(f"longer than the bound of {type_.maximum_size} characters")
        return value
    match type_.typename:
        case "boolean":
            if not isinstance(value, bool):
                raise BadValue("expected a boolean")
            return value
        case "float" | "double":
            if not isinstance(value, float) or not math.isfinite(value):
                raise BadValue("expected a finite number with a decimal point")
            return value
        case "char":
            return chr(_integer(value, 0, _LARGEST_CHARACTER))
        case typename:
            number = _integer(value, *INTEGER_RANGES[typename])
            return bytes([number]) if typename == "octet" else number


def _integer(value: object, low: int, high: int) -> int:
    if type(value) is not int or not low <= value <= high:
        raise BadValue(f"expected an integer between {low} and {high}")
    return value


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

"""From a type as a file spells it (`string<=5[<=3]`, `geometry_msgs/Pose[]`) to what it is, and back."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

from ifgen.definition import names
from ifgen.definition.interfaces import Scalar
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    StringType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
)
from ifgen.diagnostics import shorten

PRIMITIVES: Final[dict[str, BasicType | StringType]] = {
    "bool": BasicType("boolean"),
    "byte": BasicType("octet"),
    "char": BasicType("uint8"),
    "int8": BasicType("int8"),
    "uint8": BasicType("uint8"),
    "int16": BasicType("int16"),
    "uint16": BasicType("uint16"),
    "int32": BasicType("int32"),
    "uint32": BasicType("uint32"),
    "int64": BasicType("int64"),
    "uint64": BasicType("uint64"),
    "float32": BasicType("float"),
    "float64": BasicType("double"),
    "string": UnboundedString(),
    "wstring": UnboundedWString(),
}


class BadType(NamedTuple):
    """The reasons why a text is not a type, with the characters in question; explain.py adds the advice."""

    rule: str
    message: str
    start: int
    end: int


@lru_cache(maxsize=8192)
def field_type(text: str, package: str) -> FieldType | BadType:
    """The type that `text` spells inside `package`; whether a named type exists is not looked at."""
    if not text.endswith("]"):
        return _value_type(text, package)
    opening = text.rfind("[")
    if opening < 0:
        return BadType("invalid-type", f"`{shorten(text)}` has a `]` without a `[`", len(text) - 1, len(text))
    value_type = _value_type(text[:opening], package)
    if isinstance(value_type, BadType):
        return value_type
    size_text = text[opening + 1 : -1]
    if not size_text:
        # rosidl_parser applies the bound of a wstring to a sequence that has none; so does the hash.
        if isinstance(value_type, BoundedWString):
            return BoundedSequence(value_type, value_type.maximum_size)
        return UnboundedSequence(value_type)
    size = _positive(size_text.removeprefix("<="))
    if size is None:
        message = "the size of an array must be a whole number above 0"
        return BadType("invalid-size", message, opening + 1, len(text) - 1)
    return (BoundedSequence if size_text.startswith("<=") else Array)(value_type, size)


def _value_type(text: str, package: str) -> ValueType | BadType:
    primitive = PRIMITIVES.get(text)
    if primitive is not None:
        return primitive
    if text.startswith("string<="):
        return _bounded(text, "string<=", BoundedString)
    if text.startswith("wstring<="):
        return _bounded(text, "wstring<=", BoundedWString)
    first, slash, rest = text.partition("/")
    named, name = (first, rest) if slash else (package, text)
    if names.is_package_name(named) and names.is_message_name(name):
        return NamespacedType(named, "msg", name)
    return BadType("invalid-type", f"`{shorten(text)}` is not a type", 0, len(text))


def _bounded(
    text: str, prefix: str, string: type[BoundedString] | type[BoundedWString]
) -> BoundedString | BoundedWString | BadType:
    bound = _positive(text[len(prefix) :])
    if bound is None:
        message = "the bound of a string must be a whole number above 0"
        return BadType("invalid-size", message, len(prefix), max(len(text), len(prefix) + 1))
    return string(bound)


def _positive(digits: str) -> int | None:
    """The number, as Python's int() reads it, for rosidl uses that; None if it is none or not above 0."""
    try:
        number = int(digits)
    except ValueError:
        return None
    return number if number > 0 else None


# `char` and `uint8` are one type, and it is spelled `uint8`.
_SPELLED: Final = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}


def spelled(type_: FieldType, package: str | None = None) -> str:
    """A type as a file inside `package` spells it; with the packages of all messages where that is None."""
    match type_:
        case BasicType(typename):
            return _SPELLED.get(typename, typename)
        case UnboundedString():
            return "string"
        case UnboundedWString():
            return "wstring"
        case BoundedString(maximum):
            return f"string<={maximum}"
        case BoundedWString(maximum):
            return f"wstring<={maximum}"
        case NamespacedType():
            return type_.name if type_.package == package else f"{type_.package}/{type_.name}"
        case Array(value_type, size):
            return f"{spelled(value_type, package)}[{size}]"
        case BoundedSequence(value_type, maximum):
            return f"{spelled(value_type, package)}[<={maximum}]"
        case UnboundedSequence(value_type):
            return f"{spelled(value_type, package)}[]"


def spelled_value(value: Scalar | tuple[Scalar, ...]) -> str:
    """The value of a constant or a default as a file spells it."""
    match value:
        case tuple():
            return f"[{', '.join(map(spelled_value, value))}]"
        case bool():
            return "true" if value else "false"
        case bytes():
            return str(value[0])
        case str():
            quoted = value.replace("\\", "\\\\").replace('"', '\\"')
            return f'"{quoted}"'
        case _:
            return str(value)

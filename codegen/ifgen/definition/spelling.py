"""From a type as it is spelled in a file (`string<=5[<=3]`, `geometry_msgs/Pose[]`) to what it is."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

from ifgen.definition import names
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
    """Why a type's text is no type, and which of its characters are to blame."""

    rule: str
    message: str
    help: str | None
    start: int
    end: int


@lru_cache(maxsize=8192)
def field_type(text: str, package: str) -> FieldType | BadType:
    """The type that `text` spells inside `package`; whether a named type exists is not looked at."""
    if not text.endswith("]"):
        return _value_type(text, package)
    opening = text.rfind("[")
    if opening < 0:
        return BadType("invalid-type", "`]` without a `[` before it", _ARRAY_HELP, len(text) - 1, len(text))
    size_text = text[opening + 1 : -1]
    value_type = _value_type(text[:opening], package)
    if isinstance(value_type, BadType) or not size_text:
        return value_type if isinstance(value_type, BadType) else UnboundedSequence(value_type)
    digits = size_text.removeprefix("<=")
    size = _positive(digits)
    if size is None:
        start = len(text) - 1 - len(digits)
        message = "the size of an array must be a whole number above 0"
        return BadType("invalid-size", message, _ARRAY_HELP, start if digits else start - 1, len(text) - 1)
    return BoundedSequence(value_type, size) if size_text.startswith("<=") else Array(value_type, size)


_ARRAY_HELP: Final = "write `T[N]` for exactly N elements, `T[<=N]` for at most N, `T[]` for any number"
_STRING_HELP: Final = "write `string<=N` for at most N characters"


def _value_type(text: str, package: str) -> ValueType | BadType:
    primitive = PRIMITIVES.get(text)
    if primitive is not None:
        return primitive
    for prefix, bounded in (("string<=", BoundedString), ("wstring<=", BoundedWString)):
        if text.startswith(prefix):
            bound = _positive(text[len(prefix) :])
            if bound is None:
                message = "the bound of a string must be a whole number above 0"
                return BadType("invalid-size", message, _STRING_HELP, len(prefix), len(text))
            return bounded(bound)
    return _named_type(text, package)


def _positive(digits: str) -> int | None:
    """The number, as Python's int() reads it (rosidl uses that); None if it is none or not above 0."""
    try:
        number = int(digits)
    except ValueError:
        return None
    return number if number > 0 else None


def _named_type(text: str, package: str) -> NamespacedType | BadType:
    first, slash, rest = text.partition("/")
    package, name = (first, rest) if slash else (package, text)
    if not names.is_package_name(package) or not names.is_message_name(name):
        return BadType("invalid-type", f"`{text}` is not a type", None, 0, len(text))
    return NamespacedType(package, "msg", name)

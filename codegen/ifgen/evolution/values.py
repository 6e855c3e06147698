"""Values of types: the bytes that they become, and what Python code reads and may assign."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from math import inf
from typing import Any, Final, TypeAlias

from ifgen.definition.interfaces import Constant, Field, Message, Registry, Scalar
from ifgen.definition.literals import INTEGER_RANGES
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    CollectionType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
)

Layout: TypeAlias = "tuple[tuple[int, Unit], ...]"
"""Units with their number, one after the other; neighbours differ."""

Unit: TypeAlias = "str | tuple[str, Layout]"
"""The name of a basic type, or a sequence or an array with the layout of its elements."""

# One octet each, with the same eight bits for what one calls the same value.
_OCTETS: Final = {"octet": "uint8", "char": "uint8"}
_PLACEHOLDER: Final[Layout] = ((1, "nothing"),)  # the byte of an empty message has no meaning


class Layouts:
    """The layouts of the types in a registry, each worked out once."""

    def __init__(self, registry: Registry) -> None:
        self._registry = registry
        self._messages: dict[str, Layout] = {}

    def of(self, type_: FieldType) -> Layout:
        """The layout of values of a type. Bounds are not in it: no byte tells of them."""
        match type_:
            case BasicType(typename):
                return ((1, _OCTETS.get(typename, typename)),)
            case UnboundedString() | BoundedString():
                return ((1, "string"),)
            case UnboundedWString() | BoundedWString():
                return ((1, "wstring"),)
            case NamespacedType():
                return self._of_message(type_.type_name)
            case Array(value_type, size):
                return _repeated(self.of(value_type), size)
            case BoundedSequence(value_type) | UnboundedSequence(value_type):
                return ((1, ("sequence", self.of(value_type))),)

    def _of_message(self, type_name: str) -> Layout:
        if type_name not in self._messages:
            self._messages[type_name] = self.of_message(self._registry.message(type_name))
        return self._messages[type_name]

    def of_message(self, message: Message) -> Layout:
        """The layout of a message: an empty one has a byte, too."""
        units: list[tuple[int, Unit]] = []
        for field in message.fields:
            for count, unit in self.of(field.type):
                before = units.pop()[0] if units and units[-1][1] == unit else 0
                units.append((before + count, unit))
        return tuple(units) or _PLACEHOLDER


def _repeated(layout: Layout, size: int) -> Layout:
    match layout:
        case ((count, unit),):
            return ((count * size, unit),)
        case _:
            return layout if size == 1 else ((size, ("array", layout)),)


Renamed: TypeAlias = Callable[[str], str]
"""The name that a type of the old version has in the new one."""

_ZEROS: Final[dict[str, Any]] = {"boolean": False, "octet": b"\0", "char": "\0", "float": 0.0, "double": 0.0}
_IN_LISTS: Final = ("boolean", "octet", "char")
"""Basic types whose arrays and sequences are lists; those of the others are made for numbers of one type."""


def accepts(new: FieldType, old: FieldType, renamed: Renamed) -> bool:
    """Whether a field of type `new` takes all that one of type `old` takes, with values of the same class."""
    match old, new:
        case (Array(), Array()):
            return new.size == old.size and _elements(new, old, renamed)
        case ((BoundedSequence() | UnboundedSequence()), (BoundedSequence() | UnboundedSequence())):
            return _most(new) >= _most(old) and _elements(new, old, renamed)
        case ((Array() | BoundedSequence() | UnboundedSequence()), _):
            return False
        case (_, (Array() | BoundedSequence() | UnboundedSequence())):
            return False
        case _:
            return _value(new, old, renamed)


def zero(type_: FieldType) -> Any:
    """The value of a field without a default, as comparable data; None for a message."""
    match type_:
        case BasicType(typename):
            return _ZEROS.get(typename, 0)
        case NamespacedType():
            return None
        case Array(value_type, size):
            return (zero(value_type), size)
        case BoundedSequence() | UnboundedSequence():
            return ()
        case _:
            return ""


def same_default(old: Field, new: Field) -> bool:
    """Whether a new message has the same value in the field, and the class still tells the default."""
    if old.default_value is not None and new.default_value is None:
        return False  # the class has no constant NAME__DEFAULT any more
    return _in_new(old) == _in_new(new)


def same_constant(old: Constant, new: Constant) -> bool:
    """Whether two constants are the same in Python."""
    return repr(old.value) == repr(new.value)


def _in_new(field: Field) -> str:
    """The value of a field in a new message. Arrays of one value are written in short: they may be long."""
    if field.default_value is None:
        return repr(zero(field.type))
    values = field.default_value if isinstance(field.default_value, tuple) else (field.default_value,)
    element = field.type.value_type if isinstance(field.type, CollectionType) else field.type
    if element == BasicType("float"):
        values = tuple(map(_as_float32, values))
    if not isinstance(field.type, CollectionType):
        return repr(values[0])
    if isinstance(field.type, Array) and len(set(map(repr, values))) == 1:
        return repr((values[0], field.type.size))
    return repr(values)


def _as_float32(value: Scalar) -> float:
    assert isinstance(value, float)
    try:
        number: float = struct.unpack("f", struct.pack("f", value))[0]
    except OverflowError:
        return math.copysign(inf, value)
    return number


def _elements(new: CollectionType, old: CollectionType, renamed: Renamed) -> bool:
    if _is_number(old.value_type) or _is_number(new.value_type):
        return new.value_type == old.value_type  # numpy and array.array have one type of elements
    return _value(new.value_type, old.value_type, renamed)


def _is_number(type_: ValueType) -> bool:
    return isinstance(type_, BasicType) and type_.typename not in _IN_LISTS


def _value(new: ValueType, old: ValueType, renamed: Renamed) -> bool:
    match old, new:
        case (BasicType(before), BasicType(after)):
            return before == after or _wider(after, before)
        case (NamespacedType(), NamespacedType()):
            return new.type_name == renamed(old.type_name)
        case ((BasicType() | NamespacedType()), _) | (_, (BasicType() | NamespacedType())):
            return False
        case _:
            return _most_characters(new) >= _most_characters(old)


def _wider(new: str, old: str) -> bool:
    if (old, new) == ("float", "double"):
        return True
    if old not in INTEGER_RANGES or new not in INTEGER_RANGES or "octet" in {old, new}:
        return False
    (low, high), (lowest, highest) = INTEGER_RANGES[old], INTEGER_RANGES[new]
    return lowest <= low and high <= highest


def _most(type_: BoundedSequence | UnboundedSequence) -> float:
    return type_.maximum_size if isinstance(type_, BoundedSequence) else inf


def _most_characters(type_: ValueType) -> float:
    match type_:
        case BoundedString(bound) | BoundedWString(bound):
            return bound
        case UnboundedString() | UnboundedWString():
            return inf
        case _:
            raise AssertionError(type_)

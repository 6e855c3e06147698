"""The types of fields in a type description, by their numbers, and limits for types from elsewhere.

The limits are for nesting that recursion can follow, and for arrays that fit into memory.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from ifgen.definition.impossible import needed_first, value_count
from ifgen.definition.interfaces import Message
from ifgen.definition.references import references
from ifgen.definition.type_description import Kind, TypeId
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
)

_LARGEST: Final = 2**64 - 1
_PLAIN: Final[Mapping[int, ValueType]] = {
    TypeId.INT8: BasicType("int8"),
    TypeId.UINT8: BasicType("uint8"),
    TypeId.INT16: BasicType("int16"),
    TypeId.UINT16: BasicType("uint16"),
    TypeId.INT32: BasicType("int32"),
    TypeId.UINT32: BasicType("uint32"),
    TypeId.INT64: BasicType("int64"),
    TypeId.UINT64: BasicType("uint64"),
    TypeId.FLOAT: BasicType("float"),
    TypeId.DOUBLE: BasicType("double"),
    TypeId.CHAR: BasicType("char"),
    TypeId.BOOLEAN: BasicType("boolean"),
    TypeId.BYTE: BasicType("octet"),
    TypeId.STRING: UnboundedString(),
    TypeId.WSTRING: UnboundedWString(),
}


class BadDescription(Exception):
    """A mistake in a type description, in one sentence."""


def field_type(document: Mapping[str, object], where: str) -> FieldType:
    """The type of a field; `where` names the field. Raises BadDescription."""
    number = _number(document, "type_id", where)
    capacity = _number(document, "capacity", where)
    string_capacity = _number(document, "string_capacity", where)
    nested = document.get("nested_type_name", "")
    kind, of_value = divmod(number, Kind.ARRAY)
    value_type = _value_type(of_value, string_capacity, nested)
    kinds = {Kind.VALUE: 0, Kind.ARRAY: 1, Kind.BOUNDED_SEQUENCE: 2, Kind.UNBOUNDED_SEQUENCE: 3}
    if value_type is None or kind not in kinds.values():
        raise BadDescription(f"{where} has the type id {number}, which no ROS message has")
    if bool(nested) != isinstance(value_type, NamespacedType):
        raise BadDescription(f"{where} has the type id {number} and the nested type {nested!r}")
    if bool(string_capacity) != isinstance(value_type, BoundedString | BoundedWString):
        raise BadDescription(f"{where} has the type id {number} and the string capacity {string_capacity}")
    is_sized = kind in (kinds[Kind.ARRAY], kinds[Kind.BOUNDED_SEQUENCE])
    if bool(capacity) != is_sized:
        raise BadDescription(f"{where} has the type id {number} and the capacity {capacity}")
    if is_sized:
        return (Array if kind == kinds[Kind.ARRAY] else BoundedSequence)(value_type, capacity)
    return UnboundedSequence(value_type) if kind else value_type


def _value_type(type_id: int, string_capacity: int, nested: object) -> ValueType | None:
    match type_id:
        case TypeId.NESTED:
            if not isinstance(nested, str) or nested.count("/") != 2:
                return None
            return NamespacedType(*nested.split("/"))
        case TypeId.BOUNDED_STRING:
            return BoundedString(string_capacity)
        case TypeId.BOUNDED_WSTRING:
            return BoundedWString(string_capacity)
        case _:
            return _PLAIN.get(type_id)


def _number(document: Mapping[str, object], key: str, where: str) -> int:
    value = document.get(key, 0)
    if type(value) is not int or not 0 <= value <= _LARGEST:
        raise BadDescription(f"{where} has no number for '{key}'")
    return value


_DEEPEST: Final = 64
"""Levels of nesting: the deepest interface of ROS has 7."""

_MOST_VALUES: Final = 2**27
"""Values in a default message, those in its arrays included."""


def check_limits(messages: Iterable[Message]) -> None:
    """Raise BadDescription if a message is nested too deeply or has too large arrays.

    The messages are a closed set without cycles.
    """
    levels: dict[str, int] = {}
    values: dict[str, int] = {}
    for message in needed_first({message.type_name: message for message in messages}):
        name = message.type_name
        levels[name] = 1 + max((levels[type_.type_name] for _, type_ in references(message)), default=0)
        values[name] = sum(value_count(field.type, values) for field in message.fields)
        if levels[name] > _DEEPEST:
            raise BadDescription(f"{name} is nested more than {_DEEPEST} levels deep")
        if values[name] > _MOST_VALUES:
            raise BadDescription(f"a default message of {name} has more than {_MOST_VALUES} values")

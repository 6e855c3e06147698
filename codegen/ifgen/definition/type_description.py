"""Type descriptions and type hashes as REP-2016 (once REP-2011) has them.

A description is the dictionary that rosidl writes into an interface's .json file as `type_description_msg`.
The order of its keys matters, because the hash is computed from its JSON text.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator
from enum import IntEnum
from typing import Any, Final, TypeAlias

from ifgen.definition.interfaces import Action, Field, Interface, Message, Registry, Scalar, Service
from ifgen.definition.names import PLACEHOLDER
from ifgen.definition.types import (
    COLLECTIONS,
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


class TypeId(IntEnum):
    """The type ids of type_description_interfaces/msg/FieldType, for a value or an element."""

    NESTED = 1
    INT8 = 2
    UINT8 = 3
    INT16 = 4
    UINT16 = 5
    INT32 = 6
    UINT32 = 7
    INT64 = 8
    UINT64 = 9
    FLOAT = 10
    DOUBLE = 11
    LONG_DOUBLE = 12
    CHAR = 13
    WCHAR = 14
    BOOLEAN = 15
    BYTE = 16
    STRING = 17
    WSTRING = 18
    FIXED_STRING = 19
    FIXED_WSTRING = 20
    BOUNDED_STRING = 21
    BOUNDED_WSTRING = 22


class Kind(IntEnum):
    """The containers there: a `type_id` is one of these plus the TypeId."""

    VALUE = 0
    ARRAY = 48
    BOUNDED_SEQUENCE = 96
    UNBOUNDED_SEQUENCE = 144


Described: TypeAlias = Message | Service | Action

_BASIC_IDS: Final = {
    "int8": TypeId.INT8,
    "uint8": TypeId.UINT8,
    "int16": TypeId.INT16,
    "uint16": TypeId.UINT16,
    "int32": TypeId.INT32,
    "uint32": TypeId.UINT32,
    "int64": TypeId.INT64,
    "uint64": TypeId.UINT64,
    "float": TypeId.FLOAT,
    "double": TypeId.DOUBLE,
    "char": TypeId.CHAR,
    "boolean": TypeId.BOOLEAN,
    "octet": TypeId.BYTE,
}
_PLACEHOLDER: Final = Field(PLACEHOLDER, BasicType("uint8"))


def described_types(interface: Interface) -> Iterator[Described]:
    """Everything of an interface that is described: 1 type of a message, 4 of a service, 13 of an action."""
    yield interface
    match interface:
        case Service():
            yield from interface.messages
        case Action():
            yield from (interface.goal, interface.result, interface.feedback, interface.feedback_message)
            yield from described_types(interface.send_goal)
            yield from described_types(interface.get_result)
        case Message():
            pass


def messages_of(described: Described) -> list[str]:
    """The names of the messages that a description is made of: those that these hold come besides."""
    if isinstance(described, Message):
        return [described.type_name]
    return [d.type_name for d in described_types(described) if isinstance(d, Message)]


def describe(interface: Described, registry: Registry) -> dict[str, Any]:
    """The type description of a message, service or action and of everything that it refers to."""
    return {
        "type_description": _individual(interface),
        "referenced_type_descriptions": list(map(_individual, referenced_types(interface, registry))),
    }


def type_id(type_: FieldType) -> int:
    """The number of a field's type in a type description."""
    return int(_field_type(type_)["type_id"])


def type_hash(interface: Described, registry: Registry) -> str:
    """The hash that ROS knows a type by: `RIHS01_` and 64 hexadecimal digits. Defaults do not count in it."""
    return TypeHashes(registry).of(interface)


class TypeHashes:
    """The type hashes of what is in a registry; each type is described once for all that refer to it."""

    def __init__(self, registry: Registry) -> None:
        self._registry = registry
        self._texts: dict[str, str] = {}
        self._hashes: dict[str, str] = {}
        self._direct: dict[str, tuple[tuple[str, Described], ...]] = {}

    def of(self, interface: Described) -> str:
        """The type hash of a message, service or action."""
        name = interface.type_name
        if name not in self._hashes:
            self._hashes[name] = self._hash(interface)
        return self._hashes[name]

    def referenced(self, interface: Described) -> list[Described]:
        """Everything that an interface refers to, directly or not, by name."""
        return _closure(interface, self._references)

    def _references(self, interface: Described) -> tuple[tuple[str, Described], ...]:
        name = interface.type_name
        if name not in self._direct:
            self._direct[name] = tuple(_references(interface, self._registry))
        return self._direct[name]

    def _hash(self, interface: Described) -> str:
        referenced = ", ".join(map(self._text, self.referenced(interface)))
        # The same text as json.dumps of `describe`, without the defaults.
        text = (
            f'{{"type_description": {self._text(interface)}, "referenced_type_descriptions": [{referenced}]}}'
        )
        return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()

    def _text(self, described: Described) -> str:
        name = described.type_name
        if name not in self._texts:
            individual = _individual(described)
            for field in individual["fields"]:
                del field["default_value"]
            self._texts[name] = json.dumps(individual, separators=(", ", ": "), ensure_ascii=True)
        return self._texts[name]


def referenced_types(interface: Described, registry: Registry) -> list[Described]:
    """Everything that an interface refers to, directly or not, by name."""
    return _closure(interface, lambda each: _references(each, registry))


def _closure(
    interface: Described, references: Callable[[Described], Iterable[tuple[str, Described]]]
) -> list[Described]:
    known: dict[str, Described] = {}
    pending: list[Described] = [interface]
    while pending:
        for name, referenced in references(pending.pop()):
            if name not in known:
                known[name] = referenced
                pending.append(referenced)
    return [known[name] for name in sorted(known)]


def _parts(interface: Described) -> tuple[tuple[str, Described], ...]:
    """The members that a service and an action have in their descriptions."""
    match interface:
        case Message():
            return ()
        case Service():
            return (
                ("request_message", interface.request),
                ("response_message", interface.response),
                ("event_message", interface.event),
            )
        case Action():
            return (
                ("goal", interface.goal),
                ("result", interface.result),
                ("feedback", interface.feedback),
                ("send_goal_service", interface.send_goal),
                ("get_result_service", interface.get_result),
                ("feedback_message", interface.feedback_message),
            )


def _references(interface: Described, registry: Registry) -> Iterator[tuple[str, Described]]:
    if not isinstance(interface, Message):
        for _, part in _parts(interface):
            yield part.type_name, part
        return
    for field in interface.fields:
        value_type = _value_type(field.type)
        if isinstance(value_type, NamespacedType):
            yield value_type.type_name, registry.message(value_type.type_name)


def _individual(interface: Described) -> dict[str, Any]:
    if isinstance(interface, Message):
        fields = [
            {"name": field.name, "type": _field_type(field.type), "default_value": _default_text(field)}
            for field in interface.fields or (_PLACEHOLDER,)
        ]
    else:
        fields = [
            {"name": name, "type": _type(TypeId.NESTED, 0, 0, part.type_name), "default_value": ""}
            for name, part in _parts(interface)
        ]
    return {"type_name": interface.type_name, "fields": fields}


def _type(type_id: int, capacity: int, string_capacity: int, nested_type_name: str) -> dict[str, int | str]:
    return {
        "type_id": int(type_id),
        "capacity": capacity,
        "string_capacity": string_capacity,
        "nested_type_name": nested_type_name,
    }


def _field_type(type_: FieldType) -> dict[str, int | str]:
    match type_:
        case Array(size=capacity):
            kind = Kind.ARRAY
        case BoundedSequence(maximum_size=capacity):
            kind = Kind.BOUNDED_SEQUENCE
        case UnboundedSequence():
            kind, capacity = Kind.UNBOUNDED_SEQUENCE, 0
        case _:
            kind, capacity = Kind.VALUE, 0
    type_id, string_capacity, nested_type_name = _element_type(_value_type(type_))
    return _type(kind + type_id, capacity, string_capacity, nested_type_name)


def _element_type(type_: ValueType) -> tuple[int, int, str]:
    match type_:
        case NamespacedType():
            return TypeId.NESTED, 0, type_.type_name
        case BasicType():
            return _BASIC_IDS[type_.typename], 0, ""
        case UnboundedString():
            return TypeId.STRING, 0, ""
        case UnboundedWString():
            return TypeId.WSTRING, 0, ""
        case BoundedString():
            return TypeId.BOUNDED_STRING, type_.maximum_size, ""
        case BoundedWString():
            return TypeId.BOUNDED_WSTRING, type_.maximum_size, ""


def _value_type(type_: FieldType) -> ValueType:
    if isinstance(type_, COLLECTIONS):
        return type_.value_type
    return type_


def _default_text(field: Field) -> str:
    """The default as Python text, octets and characters as integers: rosidl's own form."""
    value = field.default_value
    if value is None:
        return ""
    is_character = _value_type(field.type) == BasicType("char")
    if isinstance(value, tuple):
        return str(tuple(_number(item, is_character) for item in value))
    return str(_number(value, is_character))


def _number(value: Scalar, is_character: bool) -> Scalar:
    """The number of an octet or a character; any other value unchanged."""
    if isinstance(value, bytes):
        return value[0]
    return ord(value) if is_character and isinstance(value, str) else value

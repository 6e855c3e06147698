"""Type descriptions (REP-2016) of interface classes, and the sources that the classes were generated from."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

from ifgen_runtime.field_types import Basic, Field, Text, fields_of

from rmw_local.message import is_service_class, type_name

_BASIC_IDS = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float": 10,
    "double": 11,
    "boolean": 15,
    "octet": 16,
}
_NESTED, _STRING, _WSTRING, _BOUNDED_STRING, _BOUNDED_WSTRING = 1, 17, 18, 21, 22
_ARRAY, _BOUNDED, _UNBOUNDED = 48, 96, 144

# What rosidl puts into an empty message.
_PLACEHOLDER = ("structure_needs_at_least_one_member", (_BASIC_IDS["uint8"], 0, 0, ""), "")

# A field's type: type id, capacity, string capacity, nested type name.
_Type = tuple[int, int, int, str]


def individual(cls: type[Any]) -> tuple[str, list[tuple[str, _Type, str]]]:
    """Return the name of a type and its fields as (name, type, default value in Python's spelling)."""
    if is_service_class(cls):
        parts = {"request_message": cls.Request, "response_message": cls.Response, "event_message": cls.Event}
        return type_name(cls), [(name, (_NESTED, 0, 0, type_name(part)), "") for name, part in parts.items()]
    fields = [(field.name, _type_of(field), _default_text(cls, field)) for field in fields_of(cls)]
    return type_name(cls), fields or [_PLACEHOLDER]


def referenced(cls: type[Any]) -> list[type[Any]]:
    """Return the classes that a class refers to, directly or not, sorted by type name."""
    known: dict[str, type[Any]] = {}
    pending = [cls]
    while pending:
        for other in _direct_references(pending.pop()):
            if type_name(other) not in known:
                known[type_name(other)] = other
                pending.append(other)
    return [known[name] for name in sorted(known)]


def source(cls: type[Any]) -> tuple[str, str, str]:
    """Return the type name, the encoding (msg, srv, action, or implicit for a derived type) and the text."""
    name = type_name(cls)
    _, kind, short_name = name.split("/")
    if "_" in short_name:  # no interface has that in its name, every derived type does
        return name, "implicit", ""
    return name, kind, getattr(sys.modules[cls.__module__], "__source__", "")


def fill_response(response: Any, cls: type[Any], *, with_sources: bool) -> None:
    """Fill the response of type_description_interfaces/srv/GetTypeDescription."""
    from type_description_interfaces.msg import (
        Field as FieldMessage,
    )
    from type_description_interfaces.msg import FieldType, IndividualTypeDescription, TypeSource

    def described(each: type[Any]) -> Any:
        name, fields = individual(each)
        return IndividualTypeDescription(
            type_name=name,
            fields=[
                FieldMessage(
                    name=field_name,
                    type=FieldType(
                        type_id=kind[0], capacity=kind[1], string_capacity=kind[2], nested_type_name=kind[3]
                    ),
                    default_value=default,
                )
                for field_name, kind, default in fields
            ],
        )

    others = referenced(cls)
    response.type_description.type_description = described(cls)
    response.type_description.referenced_type_descriptions = [described(other) for other in others]
    if with_sources:
        response.type_sources = [
            TypeSource(type_name=name, encoding=encoding, raw_file_contents=text)
            for name, encoding, text in map(source, (cls, *others))
        ]


def _direct_references(cls: type[Any]) -> Iterator[type[Any]]:
    if is_service_class(cls):
        yield from (cls.Request, cls.Response, cls.Event)
        return
    for field in fields_of(cls):
        if isinstance(field.type, type):
            yield field.type


def _type_of(field: Field) -> _Type:
    if field.size is not None:
        offset, capacity = _ARRAY, field.size
    elif not field.is_sequence:
        offset, capacity = 0, 0
    elif field.maximum is not None:
        offset, capacity = _BOUNDED, field.maximum
    else:
        offset, capacity = _UNBOUNDED, 0
    of = field.type
    if isinstance(of, Basic):
        return offset + _BASIC_IDS[of.name], capacity, 0, ""
    if isinstance(of, Text):
        if of.maximum is None:
            return offset + (_WSTRING if of.wide else _STRING), capacity, 0, ""
        return offset + (_BOUNDED_WSTRING if of.wide else _BOUNDED_STRING), capacity, of.maximum, ""
    return offset + _NESTED, capacity, 0, type_name(of)


def _default_text(cls: type[Any], field: Field) -> str:
    value = getattr(cls, f"{field.name.upper()}__DEFAULT", None)
    if value is None:
        return ""
    if field.is_collection:
        values = value.tolist() if hasattr(value, "tolist") else value
        return str(tuple(_plain(item) for item in values))
    return str(_plain(value))


def _plain(value: Any) -> Any:
    """Show octets as numbers."""
    return value[0] if isinstance(value, bytes) else value

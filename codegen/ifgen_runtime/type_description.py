"""Type descriptions (REP-2016) of classes: for `~/get_type_description` and for the type support.

Works for generated classes, ours and rosidl's, since it asks them for their fields.
"""

from __future__ import annotations

import hashlib
import json
from enum import IntEnum
from typing import Any, Final

from ifgen_runtime.field_types import Basic, Field, Text, fields_of, type_name


class TypeId(IntEnum):
    """The type ids of type_description_interfaces/msg/FieldType (REP-2016), for a value or an element."""

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
_PLACEHOLDER = "structure_needs_at_least_one_member"


def describe(cls: type[Any]) -> dict[str, Any]:
    """The description of an interface class and of all that it refers to, as rosidl's .json has it."""
    return {
        "type_description": _individual(cls),
        "referenced_type_descriptions": [_individual(referenced) for referenced in _referenced_classes(cls)],
    }


def type_hash(cls: type[Any]) -> str:
    """The type hash (`RIHS01_...`) of an interface class, also of one that does not know its own."""
    return hash_of(describe(cls))


def hash_of(document: dict[str, Any]) -> str:
    """The type hash of what a description says. Its keys are in the order of `describe`."""
    hashed = {
        "type_description": _without_defaults(document["type_description"]),
        "referenced_type_descriptions": [
            _without_defaults(described) for described in document["referenced_type_descriptions"]
        ],
    }
    return f"RIHS01_{hashlib.sha256(json.dumps(hashed).encode()).hexdigest()}"


def _without_defaults(described: dict[str, Any]) -> dict[str, Any]:
    fields = [
        {key: value for key, value in field.items() if key != "default_value"}
        for field in described["fields"]
    ]
    return {**described, "fields": fields}


def sources(cls: type[Any]) -> list[tuple[str, str, str]]:
    """(type name, encoding, file contents) of a class and of all that it refers to.

    The encoding is `msg`, `srv`, `action` or `idl`. Parts of services and actions are `implicit`, without
    contents. A class that does not know its source, such as a compiled one, has no contents either.
    """
    return [(type_name(item), *_source(item)) for item in (cls, *_referenced_classes(cls))]


def _source(cls: type[Any]) -> tuple[str, str]:
    folder = cls.__module__.split(".")[1]
    if folder != "msg" and not hasattr(cls, "Goal") and not (folder == "srv" and hasattr(cls, "Request")):
        return "implicit", ""
    # Not from sys.modules: a class that was made at run time has its module to itself.
    module: dict[str, Any] = getattr(cls.__init__, "__globals__", {})
    return module.get("__encoding__", folder), module.get("__source__", "")


def _referenced_classes(cls: type[Any]) -> list[type[Any]]:
    """Every class below this one, once, sorted by type name."""
    known: dict[str, type[Any]] = {}
    pending = [cls]
    while pending:
        for referenced in _members(pending.pop()).values():
            if type_name(referenced) not in known:
                known[type_name(referenced)] = referenced
                pending.append(referenced)
    return [known[name] for name in sorted(known)]


def _members(cls: type[Any]) -> dict[str, type[Any]]:
    """The classes of the members of a class, without those of basic types."""
    parts = _parts(cls)
    if parts is not None:
        return parts
    return {field.name: field.type for field in fields_of(cls) if isinstance(field.type, type)}


def _parts(cls: type[Any]) -> dict[str, type[Any]] | None:
    """The members of a service's or action's description; None for a message."""
    if hasattr(cls, "Goal"):
        return {
            "goal": cls.Goal,
            "result": cls.Result,
            "feedback": cls.Feedback,
            "send_goal_service": cls.Impl.SendGoalService,
            "get_result_service": cls.Impl.GetResultService,
            "feedback_message": cls.Impl.FeedbackMessage,
        }
    if hasattr(cls, "Request"):
        return {"request_message": cls.Request, "response_message": cls.Response, "event_message": cls.Event}
    return None


def _individual(cls: type[Any]) -> dict[str, Any]:
    parts = _parts(cls)
    if parts is not None:
        fields = [_member(name, _type(TypeId.NESTED, nested=type_name(part))) for name, part in parts.items()]
    else:
        fields = [_member(field.name, _field_type(field), _default(cls, field)) for field in fields_of(cls)]
    return {
        "type_name": type_name(cls),
        "fields": fields or [_member(_PLACEHOLDER, _type(_BASIC_IDS["uint8"]))],
    }


def _member(name: str, type_: dict[str, Any], default: str = "") -> dict[str, Any]:
    return {"name": name, "type": type_, "default_value": default}


def _type(type_id: int, capacity: int = 0, string_capacity: int = 0, nested: str = "") -> dict[str, Any]:
    return {
        "type_id": int(type_id),
        "capacity": capacity,
        "string_capacity": string_capacity,
        "nested_type_name": nested,
    }


def _field_type(field: Field) -> dict[str, Any]:
    kind, capacity = Kind.VALUE, 0
    if field.size is not None:
        kind, capacity = Kind.ARRAY, field.size
    elif field.is_sequence:
        kind = Kind.UNBOUNDED_SEQUENCE if field.maximum is None else Kind.BOUNDED_SEQUENCE
        capacity = field.maximum or 0
    if isinstance(field.type, Basic):
        return _type(kind + _BASIC_IDS[field.type.name], capacity)
    if isinstance(field.type, Text):
        type_id = TypeId.STRING if field.type.maximum is None else TypeId.BOUNDED_STRING
        return _type(kind + type_id + field.type.wide, capacity, field.type.maximum or 0)
    return _type(kind + TypeId.NESTED, capacity, nested=type_name(field.type))


def _default(cls: type[Any], field: Field) -> str:
    """The default as Python text, octets and characters as integers: rosidl's own form."""
    value = getattr(cls, f"{field.name.upper()}__DEFAULT", None)
    if value is None:
        return ""
    if not field.is_collection:
        return str(_number(value, field))
    # array.array and numpy arrays become lists of Python's own numbers.
    items: list[Any] = value.tolist() if hasattr(value, "tolist") else list(value)
    return str(tuple(_number(item, field) for item in items))


def _number(value: Any, field: Field) -> Any:
    """The number of an octet or a character; any other value unchanged."""
    if isinstance(value, bytes):
        return value[0]
    return ord(value) if isinstance(field.type, Basic) and field.type.name == "char" else value

"""The numbers by which REP-2016 knows types of fields. The runtime has its own, and imports none of ifgen."""

from __future__ import annotations

from enum import IntEnum


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

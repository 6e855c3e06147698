"""C tables that rosidl and rmw read: type hashes, type descriptions, sources, introspection members.

ctypes structures, data only: every function pointer is in `ifgen_native`. Entities keep pointers into them,
so whatever is made here stays for the life of the process. Layouts: rosidl_runtime_c and
rosidl_typesupport_introspection_c of Jazzy, Kilted and Lyrical on LP64, which `probe` compares.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Mapping
from ctypes import Structure, addressof, c_bool, c_char_p, c_size_t, c_uint8, c_uint32, c_uint64, c_void_p
from typing import Any, Final

_IMMORTAL: Final[list[Any]] = []

_HASH_VERSION = 1


class _String(Structure):
    _fields_ = [("data", c_char_p), ("size", c_size_t), ("capacity", c_size_t)]


class _Sequence(Structure):
    """Any rosidl sequence: they differ in the type of `data` only."""

    _fields_ = [("data", c_void_p), ("size", c_size_t), ("capacity", c_size_t)]


class _FieldType(Structure):
    _fields_ = [
        ("type_id", c_uint8),
        ("capacity", c_uint64),
        ("string_capacity", c_uint64),
        ("nested_type_name", _String),
    ]


class Field(Structure):
    """type_description_interfaces' Field."""

    _fields_ = [("name", _String), ("type", _FieldType), ("default_value", _String)]


class _IndividualTypeDescription(Structure):
    _fields_ = [("type_name", _String), ("fields", _Sequence)]


class TypeDescription(Structure):
    """type_description_interfaces' TypeDescription."""

    _fields_ = [
        ("type_description", _IndividualTypeDescription),
        ("referenced_type_descriptions", _Sequence),
    ]


class _TypeSource(Structure):
    _fields_ = [("type_name", _String), ("encoding", _String), ("raw_file_contents", _String)]


class TypeHash(Structure):
    """rosidl_type_hash_t."""

    _fields_ = [("version", c_uint8), ("value", c_uint8 * 32)]


class Member(Structure):
    """rosidl_typesupport_introspection_c__MessageMember."""

    _fields_ = [
        ("name", c_char_p),
        ("type_id", c_uint8),
        ("string_upper_bound", c_size_t),
        ("members", c_void_p),
        ("is_key", c_bool),
        ("is_array", c_bool),
        ("array_size", c_size_t),
        ("is_upper_bound", c_bool),
        ("offset", c_uint32),
        ("default_value", c_void_p),
        ("size_function", c_void_p),
        ("get_const_function", c_void_p),
        ("get_function", c_void_p),
        ("fetch_function", c_void_p),
        ("assign_function", c_void_p),
        ("resize_function", c_void_p),
    ]


class MemberWithBuffer(Member):
    """The same since Lyrical: the flag says whether an `uint8[]` may lie on a device."""

    _fields_ = [("is_rosidl_buffer", c_bool)]


class Members(Structure):
    """rosidl_typesupport_introspection_c__MessageMembers."""

    _fields_ = [
        ("message_namespace", c_char_p),
        ("message_name", c_char_p),
        ("member_count", c_uint32),
        ("size_of", c_size_t),
        ("has_any_key_member", c_bool),
        ("members", c_void_p),
        ("init_function", c_void_p),
        ("fini_function", c_void_p),
    ]


def keep(table: Structure | ctypes.Array[Any] | c_char_p) -> int:
    """Keep a table for good and return its address."""
    _IMMORTAL.append(table)
    return addressof(table)


def type_hash(text: str) -> int:
    """The address of a rosidl_type_hash_t for `RIHS01_...`."""
    digest = bytes.fromhex(text.removeprefix("RIHS01_"))
    return keep(TypeHash(_HASH_VERSION, (c_uint8 * 32)(*digest)))


def type_description(individual: Mapping[str, Any], referenced: Iterable[Mapping[str, Any]]) -> int:
    """The address of a TypeDescription."""
    references = [_individual(item) for item in referenced]
    return keep(TypeDescription(_individual(individual), _sequence(_IndividualTypeDescription, references)))


def type_sources(sources: Iterable[tuple[str, str, str]]) -> int:
    """The address of a sequence of TypeSource, from (type name, encoding, file contents)."""
    items = [_TypeSource(*(_string(text) for text in source)) for source in sources]
    return keep(_sequence(_TypeSource, items))


def _individual(description: Mapping[str, Any]) -> _IndividualTypeDescription:
    fields = [
        Field(
            _string(field["name"]),
            _FieldType(
                field["type"]["type_id"],
                field["type"]["capacity"],
                field["type"]["string_capacity"],
                _string(field["type"]["nested_type_name"]),
            ),
            _string(field.get("default_value", "")),
        )
        for field in description["fields"]
    ]
    return _IndividualTypeDescription(_string(description["type_name"]), _sequence(Field, fields))


def _string(text: str) -> _String:
    data = text.encode()
    _IMMORTAL.append(data)  # a copy of the structure does not keep what its pointers point to
    return _String(data, len(data), len(data) + 1)


def _sequence(item_type: type[Structure], items: list[Any]) -> _Sequence:
    count = len(items)
    table = (item_type * max(count, 1))(*items)
    return _Sequence(keep(table), count, count)

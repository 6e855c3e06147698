"""Introspection tables: names and types of members, which Fast DDS makes its type objects from.

They are no memory layout: `rmw_fastrtps_cpp` reads and writes messages through callbacks only.
"""

from __future__ import annotations

from ctypes import c_char_p
from typing import Final

from ifgen_runtime.type_support.binding import member_layout, native
from ifgen_runtime.type_support.descriptions import DescribedField, Description, split
from ifgen_runtime.type_support.tables import Member, Members, keep
from ifgen_runtime.type_support.type_ids import MemberType, TypeId

_MEMBER_TYPES: Final = {
    TypeId.NESTED: MemberType.MESSAGE,
    TypeId.INT8: MemberType.INT8,
    TypeId.UINT8: MemberType.UINT8,
    TypeId.INT16: MemberType.INT16,
    TypeId.UINT16: MemberType.UINT16,
    TypeId.INT32: MemberType.INT32,
    TypeId.UINT32: MemberType.UINT32,
    TypeId.INT64: MemberType.INT64,
    TypeId.UINT64: MemberType.UINT64,
    TypeId.FLOAT: MemberType.FLOAT,
    TypeId.DOUBLE: MemberType.DOUBLE,
    TypeId.CHAR: MemberType.CHAR,
    TypeId.BOOLEAN: MemberType.BOOLEAN,
    TypeId.BYTE: MemberType.OCTET,
    TypeId.STRING: MemberType.STRING,
    TypeId.WSTRING: MemberType.WSTRING,
    TypeId.BOUNDED_STRING: MemberType.STRING,
    TypeId.BOUNDED_WSTRING: MemberType.WSTRING,
}

_SOME_SIZE: Final = 8  # of a C struct that nobody allocates


def introspection_handle(description: Description) -> int:
    """The address of an introspection handle for the described type; nested types get theirs as well."""
    return _handle(description, description.type_name, {})


def _handle(description: Description, type_name: str, made: dict[str, int]) -> int:
    if type_name not in made:
        members = [_member(description, field, made) for field in description.fields(type_name)]
        table = (member_layout() * len(members))(*members)
        package, folder, name = split(type_name)
        namespace = _text(f"{package}__{folder}")
        table_of_all = Members(
            namespace, _text(name), len(members), _SOME_SIZE, False, keep(table), None, None
        )
        made[type_name] = native().introspection(keep(table_of_all))
    return made[type_name]


def _member(description: Description, field: DescribedField, made: dict[str, int]) -> Member:
    return member_layout()(
        name=_text(field.name),
        type_id=_MEMBER_TYPES[TypeId(field.base)],
        string_upper_bound=field.string_capacity,
        members=_handle(description, field.nested_type_name, made) if field.base == TypeId.NESTED else None,
        is_array=field.is_collection,
        array_size=field.capacity,
        is_upper_bound=field.is_bounded,
    )


def _text(text: str) -> c_char_p:
    pointer = c_char_p(text.encode())
    keep(pointer)
    return pointer

"""Type support for one class: tables, a layout and two functions, handed to the C extension.

A message needs its codec and its tables. A service needs the records of its three messages. An action needs
those of its services and its feedback message, and the compiled CancelGoal and GoalStatusArray, whose objects
rclpy itself casts to C structures.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from ctypes import c_char_p
from enum import IntEnum
from typing import Any, Final

from ifgen_runtime.codec import serialize
from ifgen_runtime.codec.choice import attached
from ifgen_runtime.codec.decoding import decode_any
from ifgen_runtime.errors import DeserializationError
from ifgen_runtime.field_types import type_name
from ifgen_runtime.real_rclpy import tables
from ifgen_runtime.real_rclpy.binding import member_layout, native
from ifgen_runtime.real_rclpy.layout import DescribedField, Description, layout_of, split
from ifgen_runtime.real_rclpy.tables import Member, Members, keep
from ifgen_runtime.type_description import TypeId, describe, sources

_CAPSULES = (
    "_TYPE_SUPPORT",
    "_CREATE_ROS_MESSAGE",
    "_CONVERT_FROM_PY",
    "_CONVERT_TO_PY",
    "_DESTROY_ROS_MESSAGE",
)

_messages: dict[type, tuple[int, tuple[Any, ...]]] = {}
_services: dict[type, tuple[int, Any]] = {}


def give_type_support(cls: type[Any]) -> None:
    """Set the attributes that rclpy requires on the metaclass of a class, and on those of its parts.

    Raises TypeSupportError.
    """
    if hasattr(cls, "Goal"):
        for part in (cls.Goal, cls.Result, cls.Feedback, cls.Impl.FeedbackMessage):
            give(part, _message(part)[1])
        for service in (cls.Impl.SendGoalService, cls.Impl.GetResultService):
            give_type_support(service)
        give(cls, (_action(cls),))
    elif hasattr(cls, "Request"):
        for part in (cls.Request, cls.Response, cls.Event):
            give(part, _message(part)[1])
        give(cls, (_service(cls)[1],))
    else:
        give(cls, _message(cls)[1])


def troubles(cls: type[Any]) -> tuple[int, int, int]:
    """How many payloads of a class were dropped, how many had bytes left over, and how many the last one had.

    They are counted from when the class got its type support, for all that receives it.
    """
    counts: tuple[int, int, int] = native().troubles(_messages[cls][0])
    return counts


def give(cls: type[Any], capsules: tuple[Any, ...]) -> None:
    """Set the capsules of a message, or the one of a service or an action, on the metaclass of its class."""
    for attribute, capsule in zip(
        _CAPSULES, capsules, strict=False
    ):  # services and actions have the first only
        setattr(type(cls), attribute, capsule)


def _message(cls: type[Any]) -> tuple[int, tuple[Any, ...]]:
    if cls not in _messages:
        extension = native()
        package, folder, name = split(type_name(cls))
        description = Description(describe(cls))
        if hasattr(cls, "__codec__"):
            attached(cls)  # so that the extension finds its codec
        _messages[cls] = extension.message(
            cls,
            f"{package}::{folder}",
            name,
            introspection_handle(description),
            *type_tables(cls, description),
            _in_python(cls)[0],
            _decoder(cls),
            layout_of(cls, description),
        )
    return _messages[cls]


def _service(cls: type[Any]) -> tuple[int, Any]:
    if cls not in _services:
        extension = native()
        package, folder, name = split(type_name(cls))
        _services[cls] = extension.service(
            f"{package}::{folder}",
            name,
            *(_message(part)[0] for part in (cls.Request, cls.Response, cls.Event)),
            _event_maker(cls.Event),
            *type_tables(cls, Description(describe(cls))),
        )
    return _services[cls]


def _action(cls: type[Any]) -> Any:
    impl = cls.Impl
    return native().action(
        _service(impl.SendGoalService)[0],
        _service(impl.GetResultService)[0],
        _compiled_handle(impl.CancelGoalService),
        _message(impl.FeedbackMessage)[0],
        _compiled_handle(impl.GoalStatusMessage),
        *type_tables(cls, Description(describe(cls))),
    )


def type_tables(cls: type[Any], description: Description) -> tuple[int, int, int]:
    """The addresses of the type hash of a class, of its description and of its sources."""
    return (
        tables.type_hash(cls.__type_hash__),
        tables.type_description(description.individual, description.referenced),
        tables.type_sources(sources(cls)),
    )


# Introspection tables: names and types of members, which Fast DDS makes its type objects from. They are no
# memory layout: `rmw_fastrtps_cpp` reads and writes messages through callbacks only.


class _MemberType(IntEnum):
    """The type ids of a member in rosidl_typesupport_introspection_c/field_types.h."""

    FLOAT = 1
    DOUBLE = 2
    LONG_DOUBLE = 3
    CHAR = 4
    WCHAR = 5
    BOOLEAN = 6
    OCTET = 7
    UINT8 = 8
    INT8 = 9
    UINT16 = 10
    INT16 = 11
    UINT32 = 12
    INT32 = 13
    UINT64 = 14
    INT64 = 15
    STRING = 16
    WSTRING = 17
    MESSAGE = 18


_MEMBER_TYPES: Final = {
    TypeId.NESTED: _MemberType.MESSAGE,
    TypeId.INT8: _MemberType.INT8,
    TypeId.UINT8: _MemberType.UINT8,
    TypeId.INT16: _MemberType.INT16,
    TypeId.UINT16: _MemberType.UINT16,
    TypeId.INT32: _MemberType.INT32,
    TypeId.UINT32: _MemberType.UINT32,
    TypeId.INT64: _MemberType.INT64,
    TypeId.UINT64: _MemberType.UINT64,
    TypeId.FLOAT: _MemberType.FLOAT,
    TypeId.DOUBLE: _MemberType.DOUBLE,
    TypeId.CHAR: _MemberType.CHAR,
    TypeId.BOOLEAN: _MemberType.BOOLEAN,
    TypeId.BYTE: _MemberType.OCTET,
    TypeId.STRING: _MemberType.STRING,
    TypeId.WSTRING: _MemberType.WSTRING,
    TypeId.BOUNDED_STRING: _MemberType.STRING,
    TypeId.BOUNDED_WSTRING: _MemberType.WSTRING,
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


# What the codec in C leaves to Python, and everything where it does not run.


def _decoder(cls: type[Any]) -> Callable[[bytes], Any]:
    decode = _in_python(cls)[1]

    def decode_received(data: bytes) -> Any:
        try:
            return decode(data)
        except DeserializationError:
            # Compiled types receive what is over its bound, and an error here would end the node's spin.
            return decode_any(data, cls, bounded=False)

    return decode_received


def _in_python(cls: type[Any]) -> tuple[Callable[[Any], bytes], Callable[[bytes], Any]]:
    try:
        encode, decode, _ = vars(cls)["__codec__"]
    except KeyError:  # an older ifgen generated the class
        return serialize, cls.__deserialize__
    return encode, decode


def _event_maker(cls: type[Any]) -> Callable[..., Any]:
    """A function that makes a service event from what rcl knows of it; None for a part that it leaves out."""

    def make_event(
        event_type: int,
        sec: int,
        nanosec: int,
        client_gid: bytes,
        sequence_number: int,
        request: Any,
        response: Any,
    ) -> Any:
        event = cls()
        event.info.event_type = event_type
        event.info.stamp.sec = sec
        event.info.stamp.nanosec = nanosec
        event.info.client_gid = list(client_gid)
        event.info.sequence_number = sequence_number
        event.request = [] if request is None else [request]
        event.response = [] if response is None else [response]
        return event

    return make_event


def _compiled_handle(cls: type[Any]) -> int:
    """The address in the type support capsule of a compiled class."""
    metaclass: Any = type(cls)
    if metaclass._TYPE_SUPPORT is None:
        metaclass.__import_type_support__()
    get_pointer = ctypes.pythonapi.PyCapsule_GetPointer
    get_pointer.restype = ctypes.c_void_p
    get_pointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
    get_name = ctypes.pythonapi.PyCapsule_GetName
    get_name.restype = ctypes.c_char_p
    get_name.argtypes = [ctypes.py_object]
    capsule = metaclass._TYPE_SUPPORT
    return int(get_pointer(capsule, get_name(capsule)) or 0)

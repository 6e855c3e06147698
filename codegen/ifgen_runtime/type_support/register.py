"""Type support for one class: tables, a layout and two functions, handed to the C extension.

A message needs its codec and its tables. A service needs the records of its three messages. An action needs
those of its services and its feedback message, and the compiled CancelGoal and GoalStatusArray, whose objects
rclpy itself casts to C structures.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from ifgen_runtime.codec import serialize
from ifgen_runtime.codec.choice import attached
from ifgen_runtime.codec.decoding import decode_any
from ifgen_runtime.errors import DeserializationError
from ifgen_runtime.field_types import type_name
from ifgen_runtime.type_description import describe, sources
from ifgen_runtime.type_support import tables
from ifgen_runtime.type_support.binding import native
from ifgen_runtime.type_support.descriptions import Description, split
from ifgen_runtime.type_support.introspection import introspection_handle
from ifgen_runtime.type_support.layout import layout_of

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

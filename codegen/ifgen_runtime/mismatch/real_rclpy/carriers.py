"""Requests and responses as bytes: classes that rclpy takes and sends as any other, for types of one name.

Which definition a request has is known when it has been taken. So it is taken as it came, and decoded then.
"""

from __future__ import annotations

from typing import Any, Final

from ifgen_runtime.field_types import type_name
from ifgen_runtime.type_description import describe
from ifgen_runtime.type_support.binding import native
from ifgen_runtime.type_support.descriptions import Description, split
from ifgen_runtime.type_support.introspection import introspection_handle
from ifgen_runtime.type_support.register import give, type_tables

_ANY_LAYOUT: Final = (("R1 B0._first", b""),)  # a byte, which every body has: whatever follows is left over


class Carrier:
    """The bytes of a message, encapsulation included."""

    __slots__ = ("data",)

    def __init__(self, data: bytes) -> None:
        self.data = data


_carriers: dict[type, type[Carrier]] = {}


def carrier_of(cls: type[Any]) -> type[Carrier]:
    """A class with the type support of another, whose messages are their bytes. Raises TypeSupportError."""
    if cls not in _carriers:
        _carriers[cls] = _make(cls)
    return _carriers[cls]


def _make(cls: type[Any]) -> type[Carrier]:
    package, folder, name = split(type_name(cls))
    description = Description(describe(cls))
    carrier: type[Carrier] = type(f"{name}Meta", (type,), {})(name, (Carrier,), {"__slots__": ()})
    _, capsules = native().message(
        carrier,
        f"{package}::{folder}",
        name,
        introspection_handle(description),
        *type_tables(cls, description),
        _data,
        carrier,
        _ANY_LAYOUT,
    )
    give(carrier, capsules)
    return carrier


def _data(message: Carrier) -> bytes:
    return message.data

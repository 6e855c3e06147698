"""CDR in big endian, written from the rules of the specification, as a PowerPC would send it."""

from __future__ import annotations

import struct
from typing import Any

from ifgen_runtime.field_types import Basic, Text, fields_of


def big_endian(message: Any) -> bytes:
    """The message as plain CDR in big endian, with its header."""
    body = bytearray()
    _message(body, message)
    return b"\0\0\0\0" + bytes(body)


def _message(body: bytearray, message: Any) -> None:
    fields = fields_of(type(message))
    if not fields:
        body.append(0)
    for field in fields:
        value = getattr(message, field.slot)
        if field.is_sequence:
            _basic(body, "I", 4, len(value))
        for element in value if field.is_collection else [value]:
            _value(body, field.type, element)


def _value(body: bytearray, type_: Basic | Text | type[Any], value: Any) -> None:
    if isinstance(type_, Basic):
        value = value.encode("latin-1") if type_.name == "char" else value
        _basic(body, type_.format, type_.size, value)
    elif not isinstance(type_, Text):
        _message(body, value)
    elif type_.wide:
        units = struct.unpack(f">{len(value.encode('utf-16-be')) // 2}H", value.encode("utf-16-be"))
        _basic(body, "I", 4, len(units))
        for unit in units:
            _basic(body, "I", 4, unit)
    else:
        encoded = value.encode() + b"\0"
        _basic(body, "I", 4, len(encoded))
        body += encoded


def _basic(body: bytearray, character: str, size: int, value: Any) -> None:
    body += bytes(-len(body) % size) + struct.pack(f">{character}", value)

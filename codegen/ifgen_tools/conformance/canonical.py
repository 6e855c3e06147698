"""The canonical text of a payload, read by its definition: a second implementation of the wire."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Final

from ifgen.definition.interfaces import Registry
from ifgen.definition.types import (
    COLLECTIONS,
    Array,
    BasicType,
    BoundedWString,
    FieldType,
    NamespacedType,
    StringType,
    UnboundedWString,
    ValueType,
)

_FORMATS: Final = {
    **{"boolean": "?", "octet": "B", "char": "B", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H"},
    **{"int32": "i", "uint32": "I", "int64": "q", "uint64": "Q", "float": "I", "double": "Q"},
}


class CanonicalText:
    """Reads one payload, which must be a right one. `counts` are the places of counts and lengths in it."""

    def __init__(self, registry: Registry, type_name: str, payload: bytes) -> None:
        self._registry = registry
        self._body = payload[4:]
        self._order = "<" if payload[1] & 1 else ">"
        self._at = 0
        self.counts: list[int] = []
        self.text = " ".join(self._message("", type_name))

    def _message(self, path: str, type_name: str) -> Iterator[str]:
        fields = self._registry.message(type_name).fields
        if not fields:
            self._at += 1  # the placeholder
        for field in fields:
            yield from self._field(path + field.name, field.type)

    def _field(self, path: str, type_: FieldType) -> Iterator[str]:
        if not isinstance(type_, COLLECTIONS):
            yield from self._value(path, type_)
            return
        if isinstance(type_, Array):
            count = type_.size
        else:
            count = self._count()
            yield f"{path}#={count}"
        for index in range(count):
            yield from self._value(f"{path}[{index}]", type_.value_type)

    def _value(self, path: str, type_: ValueType) -> Iterator[str]:
        if isinstance(type_, NamespacedType):
            yield from self._message(f"{path}.", type_.type_name)
        elif isinstance(type_, BasicType):
            number = self._number(_FORMATS[type_.typename])
            digits = {"float": 8, "double": 16}.get(type_.typename)
            yield f"{path}={number:0{digits}x}" if digits else f"{path}={number:d}"
        else:
            yield f"{path}={self._string(type_).hex()}"

    def _string(self, type_: StringType) -> bytes:
        size = self._count()
        if isinstance(type_, UnboundedWString | BoundedWString):
            return struct.pack(f">{size}H", *(self._number("I") for _ in range(size)))
        self._at += size
        return self._body[self._at - size : self._at - 1]

    def _count(self) -> int:
        count = self._number("I")
        self.counts.append(self._at)  # 4 for the header, less 4 for the count
        return count

    def _number(self, character: str) -> int:
        size = struct.calcsize(character)
        self._at += -self._at % size
        self._at += size
        value: int = struct.unpack_from(self._order + character, self._body, self._at - size)[0]
        return value

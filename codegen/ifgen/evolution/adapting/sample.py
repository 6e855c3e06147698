"""A message in which no field has its default: as Python text, and as the bytes that it becomes.

The bytes are made here, not by a generated codec, so that a test of these classes has something to compare.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from math import prod
from typing import Final

from ifgen.definition.interfaces import Field, Message, Registry
from ifgen.definition.names import attribute_name
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    CollectionType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)
from ifgen.generator_py.codec.program import NUMBERS
from ifgen.generator_py.tests.strategies import enclosed

_HEADER: Final = b"\0\1\0\0"  # CDR, little endian
_MOST: Final = 2_000
"""Values in a sample: nobody reads a longer one."""


class Sample:
    """A populated message. `text` makes it, `data` are its bytes, and `values` those of its own fields."""

    def __init__(self, message: Message, registry: Registry, class_name: Callable[[Message], str]) -> None:
        self._registry = registry
        self._class_name = class_name
        self._body = bytearray()
        self._count = 0
        self.values: dict[str, str] = {}
        self._message(message, self.values)
        arguments = [f"{attribute_name(field)}={self.values[field.name]}" for field in message.fields]
        self.text = enclosed(f"{class_name(message)}(", arguments, ")", len("POPULATED_MESSAGE = "))
        self.data = _HEADER + bytes(self._body)

    def _message(self, message: Message, values: dict[str, str] | None = None) -> str:
        found = {} if values is None else values
        for field in message.fields:
            found[field.name] = self._field(field)
        if not message.fields:
            self._body.append(0)
        arguments = (f"{attribute_name(field)}={found[field.name]}" for field in message.fields)
        return f"{self._class_name(message)}({', '.join(arguments)})"

    def _field(self, field: Field) -> str:
        match field.type:
            case Array(element, size):
                return self._elements(element, size, field)
            case BoundedSequence(element, bound):
                self._number("I", min(bound, 2))
                return self._elements(element, min(bound, 2), field)
            case UnboundedSequence(element):
                self._number("I", 2)
                return self._elements(element, 2, field)
            case type_:
                self._count += 1
                return self._value(type_, self._count, field.default_value)

    def _elements(self, type_: FieldType, size: int, field: Field) -> str:
        """A list: of different elements if it is short, else of the same ones."""
        if size <= 3:
            first = self._count
            self._count += size
            return f"[{', '.join(self._value(type_, first + 1 + index, None) for index in range(size))}]"
        self._count += 1
        texts = [self._value(type_, self._count, None) for _ in range(size)]
        if isinstance(type_, NamespacedType):
            return f"[{', '.join(texts)}]"
        return f"[{texts[0]}] * {size}"

    def _value(self, type_: FieldType, count: int, default: object) -> str:
        match type_:
            case NamespacedType():
                return self._message(self._registry.message(type_.type_name))
            case BasicType("boolean"):
                self._body.append(default is not True)
                return repr(default is not True)
            case BasicType("octet"):
                self._body.append(count % 100 + 1)
                return repr(bytes([count % 100 + 1]))
            case BasicType("char"):
                self._body.append(97 + count % 26)
                return f'"{chr(97 + count % 26)}"'
            case BasicType(name):
                return self._numeric(name, count, default)
            case UnboundedString() | BoundedString():
                text = f"text {count}"[: type_.maximum_size if isinstance(type_, BoundedString) else None]
                self._number("I", len(text) + 1)
                self._body += text.encode() + b"\0"
                return f'"{text}"'
            case UnboundedWString() | BoundedWString():
                text = f"text {count}"[: type_.maximum_size if isinstance(type_, BoundedWString) else None]
                self._number("I", len(text))
                for character in text:
                    self._number("I", ord(character))
                return f'"{text}"'
            case _:
                raise AssertionError(type_)

    def _numeric(self, name: str, count: int, default: object) -> str:
        number = count % 100 + 1
        offset = {"float": 0.5, "double": 0.1}.get(name, 0)
        value = number + offset if number + offset != default else number + 1 + offset
        self._number(NUMBERS[name].format, value)  # type: ignore[index]  # what is left is a number
        return repr(value)

    def _number(self, format: str, value: float) -> None:
        size = struct.calcsize(format)
        self._body += bytes(-len(self._body) % size) + struct.pack(f"<{format}", value)


def is_too_large(message: Message, registry: Registry) -> bool:
    """Whether a message, by its arrays, has more values than a sample should."""
    return _size(message, registry, {}) > _MOST


def _size(message: Message, registry: Registry, known: dict[str, int]) -> int:
    name = message.type_name
    if name not in known:
        known[name] = 1 + sum(_values(field.type, registry, known) for field in message.fields)
    return known[name]


def _values(type_: FieldType, registry: Registry, known: dict[str, int]) -> int:
    element = type_.value_type if isinstance(type_, CollectionType) else type_
    size = type_.size if isinstance(type_, Array) else 2 if isinstance(type_, CollectionType) else 1
    inner = (
        _size(registry.message(element.type_name), registry, known)
        if isinstance(element, NamespacedType)
        else 1
    )
    return prod((size, inner))

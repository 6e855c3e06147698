"""The fields of a message class, for code that works on any class, ours or rosidl's."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any


@dataclass(frozen=True, slots=True)
class Basic:
    """A basic type: its `struct` format character, its size and alignment, its smallest and largest integer.

    `typecode` is array.array's and `dtype` is numpy's; both are empty for boolean, octet and char.
    """

    name: str
    format: str
    size: int
    typecode: str = ""
    dtype: str = ""

    @property
    def is_float(self) -> bool:
        """Whether values are Python floats."""
        return self.typecode in ("f", "d")

    @property
    def range(self) -> tuple[int, int]:
        """The smallest and the largest value of an integer type."""
        bits = 8 * self.size
        return (-(1 << bits - 1), (1 << bits - 1) - 1) if self.format.islower() else (0, (1 << bits) - 1)


BASIC_TYPES = {
    basic.name: basic
    for basic in (
        Basic("boolean", "?", 1),
        Basic("octet", "c", 1),
        Basic("char", "c", 1),
        Basic("int8", "b", 1, "b", "int8"),
        Basic("uint8", "B", 1, "B", "uint8"),
        Basic("int16", "h", 2, "h", "int16"),
        Basic("uint16", "H", 2, "H", "uint16"),
        Basic("int32", "i", 4, "i", "int32"),
        Basic("uint32", "I", 4, "I", "uint32"),
        Basic("int64", "q", 8, "q", "int64"),
        Basic("uint64", "Q", 8, "Q", "uint64"),
        Basic("float", "f", 4, "f", "float32"),
        Basic("double", "d", 8, "d", "float64"),
    )
}


@dataclass(frozen=True, slots=True)
class Text:
    """A string or wstring; `maximum` bounds its characters."""

    wide: bool
    maximum: int | None


@dataclass(frozen=True, slots=True)
class Field:
    """A field: its name on the wire, its slot, the type of its value or elements, and how many of them.

    `size` is set for arrays; `is_sequence` for sequences, and `maximum` for those with a bound.
    """

    name: str
    slot: str
    type: Basic | Text | type[Any]
    size: int | None = None
    is_sequence: bool = False
    maximum: int | None = None

    @property
    def attribute(self) -> str:
        """The name of the field in Python: `class_` for a field `class`."""
        return self.slot[1:]

    @property
    def element(self) -> str:
        """The name of the type of its value or elements: `double`, `string`, `geometry_msgs/msg/Point`."""
        if isinstance(self.type, Text):
            return "wstring" if self.type.wide else "string"
        return self.type.name if isinstance(self.type, Basic) else type_name(self.type)

    @property
    def is_collection(self) -> bool:
        """Whether it is an array or a sequence."""
        return self.is_sequence or self.size is not None


def type_name(cls: type[Any]) -> str:
    """`pkg/msg/Name` of a message, service or action class."""
    package, folder, *_ = cls.__module__.split(".")
    return f"{package}/{folder}/{cls.__name__}"


_FIELD_TYPE = re.compile(
    r"(?P<sequence>sequence<)?(?P<base>[\w/]+)(?:<(?P<bound>\d+)>)?"
    r"(?:\[(?P<size>\d+)\])?(?:, (?P<maximum>\d+))?>?"
)


_known_fields: dict[type, tuple[Field, ...]] = {}
_known_sizes: dict[type, int] = {}


def fields_of(cls: type[Any]) -> tuple[Field, ...]:
    """The fields of a message class, in the order of the wire; TypeError if it is not a message class."""
    fields = _known_fields.get(cls)
    if fields is None:
        fields = _known_fields[cls] = tuple(_fields(cls))
    return fields


def _fields(cls: type[Any]) -> Iterator[Field]:
    try:
        texts: dict[str, str] = cls._fields_and_field_types
        slots = [slot for slot in cls.__slots__ if slot != "_check_fields"]
    except AttributeError:
        raise TypeError(f"{cls!r} is not a message class") from None
    nested = iter(_nested_classes(cls))
    for (name, text), slot in zip(texts.items(), slots, strict=True):
        yield _field(name, slot, text, nested)


def _field(name: str, slot: str, text: str, nested: Iterator[type[Any]]) -> Field:
    match = _FIELD_TYPE.fullmatch(text)
    if match is None:
        raise TypeError(f"field type {text!r} of {name!r} is not known")
    base, bound = match["base"], match["bound"]
    value_type: Basic | Text | type[Any]
    if base in ("string", "wstring"):
        value_type = Text(base == "wstring", int(bound) if bound else None)
    elif base in BASIC_TYPES:
        value_type = BASIC_TYPES[base]
    else:
        value_type = next(nested)
    return Field(
        name,
        slot,
        value_type,
        size=int(match["size"]) if match["size"] else None,
        is_sequence=bool(match["sequence"]),
        maximum=int(match["maximum"]) if match["maximum"] else None,
    )


def _nested_classes(cls: type[Any]) -> Iterator[type[Any]]:
    """The classes of the fields that hold messages: ours know them, rosidl's name them in SLOT_TYPES."""
    known: tuple[type[Any], ...] | None = getattr(cls, "__nested__", None)
    if known is not None:
        yield from known
        return
    for slot_type in cls.SLOT_TYPES:
        value_type = getattr(slot_type, "value_type", slot_type)
        if hasattr(value_type, "namespaces"):
            yield message_class(".".join(value_type.namespaces), value_type.name)


def message_class(module: str, name: str) -> type[Any]:
    """The class `name` of `package.folder`. rosidl keeps the parts of an action inside the action's class."""
    folder = import_module(module)
    interface, _, part = name.rpartition("_")
    cls: type[Any] = getattr(folder, name, None) or getattr(getattr(folder, interface), part)
    return cls


def smallest_size(cls: type[Any]) -> int:
    """A lower limit for the bytes that a message takes on the wire, at least 1."""
    size = _known_sizes.get(cls)
    if size is None:
        size = _known_sizes[cls] = sum(_smallest_field(field) for field in fields_of(cls)) or 1
    return size


def _smallest_field(field: Field) -> int:
    if field.is_sequence:
        return 4
    return (1 if field.size is None else field.size) * smallest_element(field)


def smallest_element(field: Field) -> int:
    """A lower limit for the bytes that one value or element of the field takes."""
    if isinstance(field.type, Basic):
        return field.type.size
    return 4 if isinstance(field.type, Text) else smallest_size(field.type)

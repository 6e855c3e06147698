"""The types that a field can have: a closed sum, under rosidl's own class names.

Match it exhaustively. Basic types carry the IDL name that rosidl uses everywhere below the `.msg` spelling:
`bool` is `boolean`, `byte` is `octet`, `char` is `uint8`, `float32` is `float` and `float64` is `double`.
A `char` of an .idl file stays one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

BasicTypeName = Literal[
    "boolean",
    "octet",
    "char",
    "int8",
    "uint8",
    "int16",
    "uint16",
    "int32",
    "uint32",
    "int64",
    "uint64",
    "float",
    "double",
]


@dataclass(frozen=True, slots=True)
class BasicType:
    """A number, a boolean, an octet or a character."""

    typename: BasicTypeName


@dataclass(frozen=True, slots=True)
class UnboundedString:
    """`string`."""


@dataclass(frozen=True, slots=True)
class BoundedString:
    """`string<=N`; the bound counts characters in Python."""

    maximum_size: int


@dataclass(frozen=True, slots=True)
class UnboundedWString:
    """`wstring`."""


@dataclass(frozen=True, slots=True)
class BoundedWString:
    """`wstring<=N`."""

    maximum_size: int


@dataclass(frozen=True, slots=True)
class NamespacedType:
    """Another message: `pkg/msg/Name`, or a part of a service or action such as `pkg/srv/Name_Request`."""

    package: str
    folder: str
    name: str

    @property
    def type_name(self) -> str:
        """`pkg/msg/Name`."""
        return f"{self.package}/{self.folder}/{self.name}"


StringType: TypeAlias = UnboundedString | BoundedString | UnboundedWString | BoundedWString
ValueType: TypeAlias = BasicType | StringType | NamespacedType


@dataclass(frozen=True, slots=True)
class Array:
    """`T[N]`: exactly `size` elements."""

    value_type: ValueType
    size: int


@dataclass(frozen=True, slots=True)
class BoundedSequence:
    """`T[<=N]`: at most `maximum_size` elements."""

    value_type: ValueType
    maximum_size: int


@dataclass(frozen=True, slots=True)
class UnboundedSequence:
    """`T[]`."""

    value_type: ValueType


CollectionType: TypeAlias = Array | BoundedSequence | UnboundedSequence
COLLECTIONS: Final = (Array, BoundedSequence, UnboundedSequence)
"""The same classes for `isinstance`, where `A | B` would make a union at each call."""

FieldType: TypeAlias = ValueType | CollectionType


def element_of(type_: FieldType) -> ValueType:
    """The type of one element of an array or a sequence; of another field, its type."""
    return type_.value_type if isinstance(type_, COLLECTIONS) else type_

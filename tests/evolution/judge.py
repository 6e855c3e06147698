"""Judges an edit by running the classes of both versions: their hashes, their bytes, and what Python sees."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from enum import EnumType
from typing import Any, NamedTuple

import numpy as np
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.literals import INTEGER_RANGES
from ifgen.definition.type_description import type_hash
from ifgen.definition.types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    ValueType,
)

NUMBERS = {
    **{"int8": ("int8", "b"), "int16": ("int16", "h"), "int32": ("int32", "i"), "int64": ("int64", "q")},
    **{
        "uint8": ("uint8", "B"),
        "uint16": ("uint16", "H"),
        "uint32": ("uint32", "I"),
        "uint64": ("uint64", "Q"),
    },
    **{"float": ("float32", "f"), "double": ("float64", "d")},
}
"""Types whose arrays are numpy's and whose sequences are array.array: the dtype and the type code."""


BITS = 7
"""Rounds in which two fields of truth values may differ: more than any message has fields."""


class Version(NamedTuple):
    """A version of a message: its class and its name, and all classes and definitions beside it.

    The class may have been generated under another name.
    """

    cls: type[Any]
    name: str
    classes: Mapping[str, type[Any]]
    registry: Registry

    @property
    def definition(self) -> Message:
        """The definition of this version."""
        return self.registry.message(self.name)

    @property
    def type_hash(self) -> str:
        """The type hash of this version."""
        return type_hash(self.definition, self.registry)


def broken(old: Version, new: Version, renamed: Mapping[str, str]) -> set[str]:
    """The categories in which two versions of a message differ. `renamed` has fields by their old names."""
    found: set[str] = set()
    if old.type_hash != new.type_hash:
        found.add("hash")
    back = {name: earlier for earlier, name in renamed.items()}
    if not (_means_the_same(old, new, renamed) and _means_the_same(new, old, back)):
        found.add("wire")
    if not _works_as_before(old, new):
        found.add("source")
    return found


def _means_the_same(one: Version, other: Version, renamed: Mapping[str, str]) -> bool:
    """Whether each field of one class has its value in the other, after going over the wire.

    Strings and sequences are short, so that they fit whatever bound the other version has.
    """
    for round in range(2 + BITS):
        message = one.cls(**_values(one.definition, one, round, most=1))
        sent = {renamed.get(name, name): value for name, value in _by_name(message).items()}
        data = message.__serialize__()
        try:
            received = other.cls.__deserialize__(data)
            if _by_name(received) != sent or received.__serialize__() != data:
                return False
        except Exception:
            return False
    return True


def _works_as_before(old: Version, new: Version) -> bool:
    """Whether Python code finds all names, the values of new messages, and room for its own values."""
    names = [name for name in dir(old.cls) if not name.startswith("_")]
    if any(not hasattr(new.cls, name) for name in names):
        return False
    fresh, fresh_too = old.cls(), new.cls()
    fields = {field.name for field in old.definition.fields}
    for name in fields:
        was, is_ = getattr(fresh, name), getattr(fresh_too, name)
        if _class(was) != _class(is_) or repr(was) != repr(is_):
            return False
    constants = [name for name in names if name.isupper() and name not in fields and name != "SLOT_TYPES"]
    if any(repr(getattr(old.cls, name)) != repr(getattr(new.cls, name)) for name in constants):
        return False
    enums = [name for name in names if isinstance(getattr(old.cls, name), EnumType)]
    for name in enums:
        if not set(getattr(old.cls, name).__members__) <= set(getattr(new.cls, name).__members__):
            return False
    # Messages of the new version inside, where it still has them.
    values = old._replace(classes={**old.classes, **new.classes})
    return all(
        _takes(new.cls(check_fields=True), name, value)
        for round in range(3)
        for name, value in _values(old.definition, values, round, most=500).items()
    )


def _takes(message: Any, name: str, value: Any) -> bool:
    try:
        setattr(message, name, value)
    except Exception:
        return False
    return type(getattr(message, name)) is type(value)


def _class(value: Any) -> tuple[str, str]:
    """The name of a class: each version has its own classes of nested messages."""
    return type(value).__module__, type(value).__qualname__


def _values(definition: Message, version: Version, round: int, most: int, seed: int = 0) -> dict[str, Any]:
    """Legal values of all fields. Every two fields differ in at least one round of the last ones."""
    return {
        field.name: _value(field.type, version, round, most, seed + number)
        for number, field in enumerate(definition.fields)
    }


def _value(type_: FieldType, version: Version, round: int, most: int, seed: int) -> Any:
    match type_:
        case Array(value_type, size):
            count = size
        case BoundedSequence(value_type, size):
            count = (0, min(size, most), 1)[min(round, 2)]
        case UnboundedSequence(value_type):
            count = (0, most, min(2, most))[min(round, 2)]
        case _:
            return _element(type_, version, round, most, seed)
    elements = [_element(value_type, version, round, most, seed) for _ in range(count)]
    number = NUMBERS.get(value_type.typename) if isinstance(value_type, BasicType) else None
    if number is None:
        return elements
    return np.array(elements, number[0]) if isinstance(type_, Array) else array(number[1], elements)


def _element(type_: ValueType, version: Version, round: int, most: int, seed: int) -> Any:
    """The lowest value, then the highest one, then ones in between."""
    match type_:
        case NamespacedType():
            nested = version.registry.message(type_.type_name)
            return version.classes[type_.type_name](**_values(nested, version, round, 2, seed))
        case BasicType("boolean"):
            return (False, True, *(bool(seed >> bit & 1) for bit in range(BITS)))[round]
        case BasicType("octet"):
            return (b"\0", b"\xff", bytes([seed]))[min(round, 2)]
        case BasicType("float"):
            return (-0.5, float(np.float32(3e38)), seed + 0.25)[min(round, 2)]
        case BasicType("double"):
            return (-0.1, 1e300, seed + 0.1)[min(round, 2)]
        case BasicType(name):
            return (*INTEGER_RANGES[name], seed)[min(round, 2)]
        case BoundedString(bound) | BoundedWString(bound):
            return ("", "x" * min(bound, most), f"{seed}é"[:bound])[min(round, 2)]
        case _:
            return ("", "x" * most, f"{seed}é")[min(round, 2)]


def _by_name(message: Any) -> dict[str, list[Any]]:
    return {name: _leaves(getattr(message, name)) for name in message.get_fields_and_field_types()}


def _leaves(value: Any) -> list[Any]:
    """The scalars of a value, in order, an octet as its number."""
    if hasattr(value, "get_fields_and_field_types"):
        return [leaf for leaves in _by_name(value).values() for leaf in leaves]
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, str):
        return [value]
    if type(value) in {list, array, np.ndarray}:
        items: list[Any] = list(value)
        return [leaf for item in items for leaf in _leaves(item)]
    return [value]

"""From a value of an old type to one of a new type, as Python text: only where no value can be lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Final, TypeAlias

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
    ValueType,
)
from ifgen.generator_py.codec.program import NUMBERS

Converter: TypeAlias = Callable[[NamespacedType, NamespacedType], "str | None"]
"""The function that converts messages of one type to another; empty if they are the same, None if none."""

_EXACT: Final = {"float": 24, "double": 53}
"""Bits of the integers that a number holds exactly."""


@dataclass(frozen=True, slots=True)
class Conversion:
    """The text of a converted value. `function` converts the messages in it; empty if there are none.

    `is_each` is true if that is called for each element, and `is_wrapped` if the value became a sequence.
    """

    text: str
    function: str = ""
    is_each: bool = False
    is_wrapped: bool = False


def convert(old: FieldType, new: FieldType, value: str, converter: Converter) -> Conversion | None:
    """The conversion of `value`; None if a person has to decide."""
    if not isinstance(old, CollectionType):
        element = new.value_type if isinstance(new, CollectionType) else new
        found = _converted(old, element, value, converter)
        if found is None or not isinstance(new, CollectionType):
            return found
        return Conversion(f"[{found.text}]", found.function, is_wrapped=True) if _fits(1, 1, new) else None
    if not isinstance(new, CollectionType):
        return None
    size = old.size if isinstance(old, Array) else 0
    most = old.maximum_size if isinstance(old, BoundedSequence) else size or inf
    return _each(old, new, value, converter) if _fits(size, most, new) else None


def _fits(least: float, most: float, new: CollectionType) -> bool:
    """Whether the new type takes every number of elements from `least` to `most`."""
    match new:
        case Array(size=size):
            return least == most == size
        case BoundedSequence(maximum_size=bound):
            return most <= bound
        case UnboundedSequence():
            return True


def _each(old: CollectionType, new: CollectionType, value: str, converter: Converter) -> Conversion | None:
    found = _converted(old.value_type, new.value_type, "item", converter)
    if found is None:
        return None
    if _is_numeric(old.value_type) and _is_numeric(new.value_type):
        is_same = old.value_type == new.value_type and isinstance(old, Array) == isinstance(new, Array)
        return Conversion(value if is_same else f"{value}.tolist()")
    if found.text == "item":
        return Conversion(value)
    return Conversion(f"[{found.text} for item in {value}]", found.function, is_each=True)


def _is_numeric(type_: ValueType) -> bool:
    """Whether arrays and sequences of a type are arrays of numbers, and not lists."""
    return isinstance(type_, BasicType) and bool(NUMBERS[type_.typename].typecode)


def _converted(old: ValueType, new: ValueType, value: str, converter: Converter) -> Conversion | None:
    match old, new:
        case (BasicType(), BasicType()):
            text = _number(old.typename, new.typename, value)
            return None if text is None else Conversion(text)
        case (NamespacedType(), NamespacedType()):
            function = converter(old, new)
            return (
                None
                if function is None
                else Conversion(f"{function}({value})" if function else value, function)
            )
        case ((BasicType() | NamespacedType()), _) | (_, (BasicType() | NamespacedType())):
            return None
        case _:
            return Conversion(value) if _most(new) >= _most(old) else None


def _number(old: str, new: str, value: str) -> str | None:
    if old == new or (old, new) == ("float", "double"):
        return value
    if old == "octet" and new == "uint8":
        return f"{value}[0]"
    if old == "uint8" and new == "octet":
        return f"bytes([{value}])"
    if "int" not in old or "char" in {old, new}:
        return None
    signed, bits = not old.startswith("u"), int(old.removeprefix("u").removeprefix("int"))
    if new in _EXACT:
        return f"float({value})" if bits - signed <= _EXACT[new] else None
    if "int" not in new:
        return None
    new_signed, new_bits = not new.startswith("u"), int(new.removeprefix("u").removeprefix("int"))
    return value if new_signed >= signed and new_bits - new_signed >= bits - signed else None


def _most(type_: ValueType) -> float:
    match type_:
        case BoundedString(bound) | BoundedWString(bound):
            return bound
        case UnboundedString() | UnboundedWString():
            return inf
        case _:
            raise AssertionError(type_)

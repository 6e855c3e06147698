"""The form of a message in CDR: its fields as a flat list of steps.

The rules are those of XCDR1. A value is aligned to its own size, counted from the end of the 4-byte header. A
nested message adds no alignment. An empty message is one byte. Nested messages are flattened here, so that
the functions planned from the steps are straight lines; large ones are called instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from typing import TypeAlias

from ifgen.definition.interfaces import Field, Message
from ifgen.definition.types import (
    Array,
    BasicType,
    BasicTypeName,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
)
from ifgen.generator_py.codec.alignment import RunItem, run_format
from ifgen.generator_py.codec.extent import Extents
from ifgen.generator_py.names import slot_name


@dataclass(frozen=True, slots=True)
class Number:
    """A basic type on the wire: `struct` format character, size (also its alignment), numpy dtype.

    `typecode` is that of array.array; empty for booleans, octets and characters, whose arrays and sequences
    are lists.
    """

    format: str
    size: int
    typecode: str
    dtype: str


NUMBERS: dict[BasicTypeName, Number] = {
    "boolean": Number("?", 1, "", ""),
    "octet": Number("c", 1, "", ""),
    "char": Number("c", 1, "", ""),
    "int8": Number("b", 1, "b", "int8"),
    "uint8": Number("B", 1, "B", "uint8"),
    "int16": Number("h", 2, "h", "int16"),
    "uint16": Number("H", 2, "H", "uint16"),
    "int32": Number("i", 4, "i", "int32"),
    "uint32": Number("I", 4, "I", "uint32"),
    "int64": Number("q", 8, "q", "int64"),
    "uint64": Number("Q", 8, "Q", "uint64"),
    "float": Number("f", 4, "f", "float32"),
    "double": Number("d", 8, "d", "float64"),
}


@dataclass(frozen=True, slots=True)
class Count:
    """The number of elements: exactly `size`, or any number, or at most `maximum`."""

    size: int | None = None
    maximum: int | None = None


@dataclass(frozen=True, slots=True)
class Nested:
    """`target` holds a message of `type`, known as `variable` from here on. Nothing on the wire."""

    target: str
    variable: str
    type: NamespacedType


@dataclass(frozen=True, slots=True)
class Placeholder:
    """The one zero byte of a message without fields."""


@dataclass(frozen=True, slots=True)
class Scalar:
    """One basic value."""

    target: str
    type: BasicTypeName


@dataclass(frozen=True, slots=True)
class Text:
    """One string; `maximum` bounds its characters."""

    target: str
    maximum: int | None
    wide: bool


@dataclass(frozen=True, slots=True)
class Scalars:
    """An array or a sequence of a basic type."""

    target: str
    type: BasicTypeName
    count: Count


@dataclass(frozen=True, slots=True)
class Texts:
    """An array or a sequence of strings."""

    target: str
    maximum: int | None
    wide: bool
    count: Count


@dataclass(frozen=True, slots=True)
class Messages:
    """An array or a sequence of messages; in `steps`, `variable` is the element."""

    target: str
    variable: str
    type: NamespacedType
    count: Count
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Apart:
    """The message `variable`, which is so large that it has its own functions."""

    variable: str
    type: NamespacedType


Step: TypeAlias = Nested | Placeholder | Scalar | Text | Scalars | Texts | Messages | Apart


def steps_of(message: Message, extents: Extents) -> tuple[tuple[Step, ...], ...]:
    """The whole message as steps, in groups for one function each; the message itself is the variable `m`."""
    flattened = _Flattened(extents)
    return tuple(tuple(flattened.fields(group, "m")) for group in extents.groups(message))


class _Flattened:
    """Fields as steps, with what they nest in place of it."""

    def __init__(self, extents: Extents) -> None:
        self._extents = extents
        self._numbers = count(1)

    def fields(self, fields: Sequence[Field], variable: str) -> Iterator[Step]:
        """All that fields of the message `variable` take on the wire, which is all that it has."""
        if not fields:
            yield Placeholder()
        for field in fields:
            yield from self._field(field.type, f"{variable}.{slot_name(field)}")

    def _field(self, field_type: FieldType, target: str) -> Iterator[Step]:
        match field_type:
            case BasicType(typename):
                yield Scalar(target, typename)
            case NamespacedType():
                nested = self._variable()
                yield Nested(target, nested, field_type)
                yield from self._message(field_type, nested)
            case Array(value_type, size):
                yield self._collection(value_type, Count(size=size), target)
            case BoundedSequence(value_type, maximum):
                yield self._collection(value_type, Count(maximum=maximum), target)
            case UnboundedSequence(value_type):
                yield self._collection(value_type, Count(), target)
            case _:
                yield Text(target, *_text_properties(field_type))

    def _message(self, type_: NamespacedType, variable: str) -> Iterator[Step]:
        message = self._extents.registry.message(type_.type_name)
        if self._extents.of(message).is_large:
            yield Apart(variable, type_)
        else:
            yield from self.fields(message.fields, variable)

    def _collection(self, value_type: ValueType, size: Count, target: str) -> Step:
        match value_type:
            case BasicType(typename):
                return Scalars(target, typename, size)
            case NamespacedType():
                element = self._variable()
                return Messages(target, element, value_type, size, tuple(self._message(value_type, element)))
            case _:
                return Texts(target, *_text_properties(value_type), size)

    def _variable(self) -> str:
        return f"v{next(self._numbers)}"


def _text_properties(
    text: UnboundedString | BoundedString | UnboundedWString | BoundedWString,
) -> tuple[int | None, bool]:
    maximum = text.maximum_size if isinstance(text, BoundedString | BoundedWString) else None
    return maximum, isinstance(text, UnboundedWString | BoundedWString)


def entry_alignment(steps: tuple[Step, ...]) -> int:
    """The alignment of the first thing on the wire; 1 if there is none."""
    return next((_entry(step) for step in steps if not isinstance(step, Nested)), 1)


def following_alignments(steps: Sequence[Step], end: int) -> list[int]:
    """For each step the alignment after it; `end` is the alignment after all of them."""
    found: list[int] = []
    for step in reversed(steps):
        found.append(end)
        if not isinstance(step, Nested):
            end = _entry(step)
    return found[::-1]


def _entry(step: Step) -> int:
    match step:
        case Nested() | Placeholder() | Apart():  # whose function pads
            return 1
        case Scalar(type=type_) | Scalars(type=type_, count=Count(size=int())):
            return NUMBERS[type_].size
        case Messages(count=Count(size=int()), steps=inner):
            return entry_alignment(inner)
        case _:
            return 4


def largest_alignment(steps: tuple[Step, ...]) -> int:
    """The largest alignment of anything in the steps; of what is apart nothing is known."""
    largest = 1
    for step in steps:
        match step:
            case Nested() | Placeholder():
                continue
            case Apart():
                return 8
            case Scalar(type=type_) | Scalars(type=type_, count=Count(size=int())):
                largest = max(largest, NUMBERS[type_].size)
            case Scalars(type=type_):
                largest = max(largest, NUMBERS[type_].size, 4)
            case Messages(count=Count(size=int()), steps=inner):
                largest = max(largest, largest_alignment(inner))
            case Messages(steps=inner):
                largest = max(largest, largest_alignment(inner), 4)
            case _:
                largest = max(largest, 4)
    return largest


def smallest_size(steps: tuple[Step, ...]) -> int:
    """A lower limit for the bytes that the steps take, paddings not counted; at least 1."""
    total = 0
    for step in steps:
        match step:
            case Nested():
                continue
            case Placeholder() | Apart():
                total += 1
            case Scalar(type=type_):
                total += NUMBERS[type_].size
            case Scalars(type=type_, count=Count(size=int(size))):
                total += NUMBERS[type_].size * size
            case Texts(count=Count(size=int(size))):
                total += 4 * size
            case Messages(count=Count(size=int(size)), steps=inner):
                total += smallest_size(inner) * size
            case _:
                total += 4
    return total


def fixed_elements(steps: tuple[Step, ...]) -> tuple[list[RunItem], int, int] | None:
    """Items, alignment and size of an element that is laid out alike all through a sequence; None otherwise.

    That is the case if all of it is scalars that `struct` makes unchanged, the first of them has the largest
    alignment, and the size is a multiple of it.
    """
    items: list[RunItem] = []
    for step in steps:
        match step:
            case Nested():
                continue
            case Scalar(target, type_) if type_ != "char":
                number = NUMBERS[type_]
                items.append(RunItem(number.format, number.size, number.size, target))
            case Placeholder():
                items.append(RunItem("x", 1, 1, None))
            case _:
                return None
    alignment = max(item.alignment for item in items)
    size = run_format(items, 0)[1]
    if items[0].alignment != alignment or size % alignment:
        return None
    return items, alignment, size

"""The program of a message: what happens to each of its fields on the wire, in order.

The program knows CDR and the slots of fields. It does not know the language that runs it. The rules are
XCDR1's: a value is aligned to its own size, counted from the end of the 4-byte header. A nested message adds
no alignment of its own. An empty message is one byte. So no instruction says "align": the values of an
instruction imply it, and `positions` works out what is known about a position before the program runs.

Nested messages are flattened: `Enter` numbers each of them, and later slots refer to the number. Only large
messages, and those in arrays and sequences, keep instructions of their own (`Call`, `Repeat`).

The instructions are a closed sum, and each rendering matches all of them:

* Python text, in `generator_py/codec`: two straight-line functions.
* The steps of `ifgen.model`, which generators of other languages read.
* A table for the codec in C, in `generator_py/codec/table.py`: one row for each instruction and each item of
  a run. `Enter` stores a message under its number. A `Run` begins with the number of its rows, so that one
  check of the remaining space covers all of them. A `Repeat` begins with the number of rows of its body,
  which follow it.
* The check of payloads for real rclpy walks the same table, without slots and classes.

Most are named tuples: a run makes millions, and a frozen dataclass takes three times as long to make. A
named tuple cannot have a field `count`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

from ifgen.definition.types import BasicTypeName, NamespacedType


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


NUMBERS: Final[dict[BasicTypeName, Number]] = {
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


class Slot(NamedTuple):
    """The slot `name` of the message with this number. The message itself is number 0."""

    message: int
    name: str


class Count(NamedTuple):
    """The number of elements: exactly `size`, or any number, or at most `maximum`."""

    size: int | None = None
    maximum: int | None = None


class Enter(NamedTuple):
    """The slot holds a message of this type, which gets the number `message`. Nothing on the wire."""

    slot: Slot
    message: int
    type: NamespacedType


class Value(NamedTuple):
    """One basic value."""

    slot: Slot
    type: BasicTypeName


class Array(NamedTuple):
    """A fixed array of numbers, which is a numpy array in Python."""

    slot: Slot
    type: BasicTypeName
    size: int


@dataclass(frozen=True, slots=True)
class Blank:
    """The one zero byte of a message without fields."""


Item: TypeAlias = Enter | Value | Array | Blank


class Run(NamedTuple):
    """Items with the same layout in every message, except for the alignment of the start."""

    items: tuple[Item, ...]


class Text(NamedTuple):
    """One string; `maximum` bounds its characters."""

    slot: Slot
    maximum: int | None
    wide: bool


@dataclass(frozen=True, slots=True)
class Values:
    """A sequence of basic values, or an array of basic values that is a list in Python."""

    slot: Slot
    type: BasicTypeName
    count: Count


@dataclass(frozen=True, slots=True)
class Texts:
    """An array or a sequence of strings."""

    slot: Slot
    maximum: int | None
    wide: bool
    count: Count


@dataclass(frozen=True, slots=True)
class Repeat:
    """An array or a sequence of messages. In `body`, `message` is the number of the current element."""

    slot: Slot
    message: int
    type: NamespacedType
    count: Count
    body: tuple[Instruction, ...]


class Call(NamedTuple):
    """The message with this number, which is so large that it has a program of its own."""

    message: int
    type: NamespacedType


Instruction: TypeAlias = Run | Text | Values | Texts | Repeat | Call


@dataclass(frozen=True, slots=True)
class Program:
    """All instructions for a message of this type, in groups for one function each.

    Other messages call the program of a large message. Only large messages have several groups.
    """

    type: NamespacedType
    groups: tuple[tuple[Instruction, ...], ...]
    is_large: bool

    @property
    def nested(self) -> Iterator[Enter | Repeat]:
        """The places that hold other messages, in order, the outer before the inner."""
        for group in self.groups:
            yield from _nested(group)


def _nested(instructions: Iterable[Instruction]) -> Iterator[Enter | Repeat]:
    for instruction in instructions:
        match instruction:
            case Run(items):
                yield from (item for item in items if isinstance(item, Enter))
            case Repeat(body=body):
                yield instruction
                yield from _nested(body)
            case _:
                pass

"""The program of a message as a table for the codec in C: a text of rows, and the classes they refer to.

Rows have a space between them. A row is one letter for its kind and arguments with dots between them. A slot
is the number of its message and its name. A type is an index into the classes. A count is two numbers, of
which at most one is not 0: the exact number of elements, and the largest. A bound of 0 means none.

| row | instruction or item |
|---|---|
| `R5` | a `Run` of the next 5 rows |
| `E0._header.1.0` | `Enter`: slot, number of the message, type |
| `d1._x` | `Value`: the letter is its basic type |
| `Ad0._covariance.9` | `Array`: basic type, slot, size |
| `Z` | `Blank` |
| `T0._name.0`, `W0._name.0` | `Text`, not wide and wide: slot, bound |
| `Sd0._data.0.0` | `Values`: basic type, slot, count |
| `L0._names.0.0.0`, `K0._names.0.0.0` | `Texts`, not wide and wide: slot, bound, count |
| `F0._poses.1.0.0.0.7` | `Repeat`: slot, number of the element, type, count, rows of the body, which follow |
| `C1.0` | `Call`: number of the message, type |
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Final, assert_never

from ifgen.definition.types import BasicTypeName, NamespacedType
from ifgen.wire.program import (
    NUMBERS,
    Array,
    Blank,
    Call,
    Count,
    Enter,
    Instruction,
    Item,
    Program,
    Repeat,
    Run,
    Slot,
    Text,
    Texts,
    Value,
    Values,
)

_LETTERS: Final[dict[BasicTypeName, str]] = {
    **{name: number.format for name, number in NUMBERS.items()},
    "octet": "o",  # struct packs octets and characters alike
}


@dataclass(frozen=True, slots=True)
class Table:
    """The rows, and the classes of the messages inside the message, each once."""

    rows: tuple[str, ...]
    types: tuple[NamespacedType, ...]


def table_of(program: Program) -> Table:
    """The table of a program. The groups of a large message are one sequence of rows."""
    writer = _Writer()
    rows = tuple(row for group in program.groups for row in writer.rows(group))
    return Table(rows, tuple(writer.types))


@dataclass(slots=True)
class _Writer:
    types: dict[NamespacedType, int] = field(default_factory=dict[NamespacedType, int])

    def rows(self, instructions: Iterable[Instruction]) -> Iterator[str]:
        for instruction in instructions:
            yield from self._instruction(instruction)

    def _instruction(self, instruction: Instruction) -> Iterator[str]:
        match instruction:
            case Run(items):
                yield f"R{len(items)}"
                yield from map(self._item, items)
            case Text(slot, maximum, wide):
                yield f"{'W' if wide else 'T'}{_slot(slot)}.{maximum or 0}"
            case Values(slot, type_, count):
                yield f"S{_LETTERS[type_]}{_slot(slot)}.{_count(count)}"
            case Texts(slot, maximum, wide, count):
                yield f"{'K' if wide else 'L'}{_slot(slot)}.{maximum or 0}.{_count(count)}"
            case Repeat(slot, message, type_, count, instructions):
                type_index = self._type(type_)
                body = tuple(self.rows(instructions))
                yield f"F{_slot(slot)}.{message}.{type_index}.{_count(count)}.{len(body)}"
                yield from body
            case Call(message, type_):
                yield f"C{message}.{self._type(type_)}"
            case _:
                assert_never(instruction)

    def _item(self, item: Item) -> str:
        match item:
            case Enter(slot, message, type_):
                return f"E{_slot(slot)}.{message}.{self._type(type_)}"
            case Value(slot, type_):
                return f"{_LETTERS[type_]}{_slot(slot)}"
            case Array(slot, type_, size):
                return f"A{_LETTERS[type_]}{_slot(slot)}.{size}"
            case Blank():
                return "Z"
            case _:
                assert_never(item)

    def _type(self, type_: NamespacedType) -> int:
        return self.types.setdefault(type_, len(self.types))


def _slot(slot: Slot) -> str:
    return f"{slot.message}.{slot.name}"


def _count(count: Count) -> str:
    return f"{count.size or 0}.{count.maximum or 0}"

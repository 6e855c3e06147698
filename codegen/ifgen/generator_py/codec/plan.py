"""From a message to its program."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import count
from typing import Final

from ifgen.definition import types
from ifgen.definition.interfaces import Field, Message
from ifgen.definition.types import FieldType, NamespacedType, ValueType
from ifgen.generator_py.codec.extent import Extents
from ifgen.generator_py.codec.program import (
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
from ifgen.generator_py.names import slot_name

_ITEMS: Final = (Enter, Value, Array, Blank)


def plan(message: Message, extents: Extents) -> Program:
    """Plan the program of a message, or of a part of a service or action."""
    planner = _Planner(extents)
    return Program(
        NamespacedType(message.package, message.folder, message.name),
        tuple(_in_runs(planner.fields(group, 0)) for group in extents.groups(message)),
        extents.of(message).is_large,
    )


class _Planner:
    """Turns fields into instructions. Those of a nested message replace it."""

    def __init__(self, extents: Extents) -> None:
        self._extents = extents
        self._numbers = count(1)

    def fields(self, fields: Sequence[Field], message: int) -> Iterator[Item | Instruction]:
        """The size of these fields of a message on the wire. A message without fields takes a byte."""
        if not fields:
            yield Blank()
        for field in fields:
            yield from self._field(field.type, Slot(message, slot_name(field)))

    def _field(self, type_: FieldType, slot: Slot) -> Iterator[Item | Instruction]:
        match type_:
            case types.BasicType(typename):
                yield Value(slot, typename)
            case NamespacedType():
                nested = next(self._numbers)
                yield Enter(slot, nested, type_)
                yield from self._message(type_, nested)
            case types.Array(value_type, size):
                yield self._collection(value_type, Count(size=size), slot)
            case types.BoundedSequence(value_type, maximum):
                yield self._collection(value_type, Count(maximum=maximum), slot)
            case types.UnboundedSequence(value_type):
                yield self._collection(value_type, Count(), slot)
            case _:
                yield Text(slot, *_text_properties(type_))

    def _message(self, type_: NamespacedType, number: int) -> Iterator[Item | Instruction]:
        message = self._extents.registry.message(type_.type_name)
        if self._extents.of(message).is_large:
            yield Call(number, type_)
        else:
            yield from self.fields(message.fields, number)

    def _collection(self, value_type: ValueType, size: Count, slot: Slot) -> Item | Instruction:
        match value_type:
            case types.BasicType(typename):
                if size.size is not None and NUMBERS[typename].typecode:
                    return Array(slot, typename, size.size)
                return Values(slot, typename, size)
            case NamespacedType():
                element = next(self._numbers)
                return Repeat(slot, element, value_type, size, _in_runs(self._message(value_type, element)))
            case _:
                return Texts(slot, *_text_properties(value_type), size)


def _in_runs(steps: Iterable[Item | Instruction]) -> tuple[Instruction, ...]:
    """The instructions, with consecutive items in one run."""
    found: list[Instruction] = []
    items: list[Item] = []
    for step in steps:
        if isinstance(step, _ITEMS):
            items.append(step)
            continue
        if items:
            found.append(Run(tuple(items)))
            items = []
        found.append(step)
    return (*found, Run(tuple(items))) if items else tuple(found)


def _text_properties(
    text: types.UnboundedString | types.BoundedString | types.UnboundedWString | types.BoundedWString,
) -> tuple[int | None, bool]:
    maximum = text.maximum_size if isinstance(text, types.BoundedString | types.BoundedWString) else None
    return maximum, isinstance(text, types.UnboundedWString | types.BoundedWString)

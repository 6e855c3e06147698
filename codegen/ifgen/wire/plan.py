"""From a message to its program, and the size of the part of a message that one function handles.

Messages are inlined where they are nested, which multiplies their text with each level of nesting, and Python
compiles a function of many thousand lines in a time that grows faster than they do. Both end at an extent: no
function handles much more than `MOST_STEPS`, so the text of a message grows as its fields do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from operator import attrgetter
from typing import Final

from ifgen.definition import types
from ifgen.definition.interfaces import Field, Message, Registry
from ifgen.definition.references import references
from ifgen.definition.types import FieldType, NamespacedType, ValueType
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

MOST_STEPS: Final = 128

MOST_LOOPS: Final = 17
"""Python takes 20 nested blocks: the codec needs one around its loops, and a sequence of messages is one."""


@dataclass(frozen=True, slots=True)
class Extent:
    """The number of steps of a message, nested messages included.

    `steps` are the fields that its text handles one by one, and the placeholders of empty messages; `loops`
    says how deep arrays and sequences of messages are nested. `has_sequences` is true if it or a message that
    it nests has a sequence of numbers.
    """

    steps: int
    loops: int
    has_sequences: bool = False

    @property
    def is_large(self) -> bool:
        """True if the message has its own functions, which are called where it is nested."""
        return self.steps > MOST_STEPS or self.loops > MOST_LOOPS


_ONE_STEP = Extent(1, 0)


class Extents:
    """The extents of the messages in a registry, each worked out once."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self._known: dict[str, Extent] = {}

    def of(self, message: Message) -> Extent:
        """The extent of a message."""
        known = self._known.get(message.type_name)
        if known is not None:
            return known
        pending = [message]  # a stack of our own, since chains of messages may be long
        while pending:
            names = {type_.type_name for _, type_ in references(pending[-1])}
            held = [name for name in names if name not in self._known]
            if held:
                pending += map(self.registry.message, held)
            else:
                current = pending.pop()
                self._known[current.type_name] = self._sum(current)
        return self._known[message.type_name]

    def groups(self, message: Message) -> Iterator[tuple[Field, ...]]:
        """The fields of a message in order, in groups that one function handles."""
        self.of(message)
        group: list[Field] = []
        steps = 0
        for field in message.fields:
            more = self._of_field(field.type).steps
            if group and steps + more > MOST_STEPS:
                yield tuple(group)
                group, steps = [], 0
            group.append(field)
            steps += more
        yield tuple(group)

    def _sum(self, message: Message) -> Extent:
        extents = [self._of_field(field.type) for field in message.fields] or [_ONE_STEP]
        return Extent(
            sum(extent.steps for extent in extents),
            max(extent.loops for extent in extents),
            any(extent.has_sequences for extent in extents),
        )

    def _of_field(self, type_: FieldType) -> Extent:
        match type_:
            case NamespacedType():
                nested = self._nested(type_)
                return Extent(1 + nested.steps, nested.loops, nested.has_sequences)
            case (
                types.Array(NamespacedType() as element, _)
                | types.BoundedSequence(NamespacedType() as element, _)
                | types.UnboundedSequence(NamespacedType() as element)
            ):
                nested = self._nested(element)
                return Extent(1 + nested.steps, 1 + nested.loops, nested.has_sequences)
            case types.BoundedSequence(types.BasicType(name), _) | types.UnboundedSequence(
                types.BasicType(name)
            ):
                return Extent(1, 0, bool(NUMBERS[name].typecode))
            case _:
                return _ONE_STEP

    def _nested(self, type_: NamespacedType) -> Extent:
        extent = self._known[type_.type_name]
        return replace(_ONE_STEP, has_sequences=extent.has_sequences) if extent.is_large else extent


_ITEMS: Final = (Enter, Value, Array, Blank)
_NAME: Final[Callable[[Field], str]] = attrgetter("name")


def plan(message: Message, extents: Extents, slot_name: Callable[[Field], str] = _NAME) -> Program:
    """Plan the program of a message, or of a part of a service or action.

    `slot_name` gives the name for the slot of a field in the target language.
    """
    planner = _Planner(extents, slot_name)
    return Program(
        NamespacedType(message.package, message.folder, message.name),
        tuple(_in_runs(planner.fields(group, 0)) for group in extents.groups(message)),
        extents.of(message).is_large,
    )


def plan_calls(message: Message, extents: Extents) -> tuple[Instruction, ...]:
    """The instructions for the fields of a message alone: each message in it is a call."""
    return _in_runs(_Planner(extents, _NAME, calls_all=True).fields(message.fields, 0))


class _Planner:
    """Turns fields into instructions. Those of a nested message replace it."""

    def __init__(
        self, extents: Extents, slot_name: Callable[[Field], str], *, calls_all: bool = False
    ) -> None:
        self._extents = extents
        self._slot_name = slot_name
        self._calls_all = calls_all
        self._numbers = count(1)

    def fields(self, fields: Sequence[Field], message: int) -> Iterator[Item | Instruction]:
        """The size of these fields of a message on the wire. A message without fields takes a byte."""
        if not fields:
            yield Blank()
        for field in fields:
            yield from self._field(field.type, Slot(message, self._slot_name(field)))

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
        if self._calls_all or self._extents.of(message).is_large:
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

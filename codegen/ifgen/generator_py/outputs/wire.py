"""From the program of a message to the steps of `ifgen.model`, in which all alignment is resolved."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, assert_never

from ifgen.definition.interfaces import Message
from ifgen.definition.types import (
    Array,
    BasicType,
    BasicTypeName,
    FieldType,
    NamespacedType,
    element_of,
)
from ifgen.model.wire import Item, Primitive, Step, Wire
from ifgen.wire import program
from ifgen.wire.plan import Extents, plan, plan_calls
from ifgen.wire.positions import COUNT_SIZE, Alignment, Positions, tile_of
from ifgen.wire.program import (
    NUMBERS,
    Blank,
    Call,
    Count,
    Enter,
    Instruction,
    Repeat,
    Run,
    Text,
    Texts,
    Values,
)

PRIMITIVES: Final[Mapping[BasicTypeName, Primitive]] = {
    "boolean": "bool",
    "octet": "byte",
    "char": "char",
    "int8": "int8",
    "uint8": "uint8",
    "int16": "int16",
    "uint16": "uint16",
    "int32": "int32",
    "uint32": "uint32",
    "int64": "int64",
    "uint64": "uint64",
    "float": "float32",
    "double": "float64",
}

_START: Final = Alignment(8, 0)
_ANYWHERE: Final = Alignment(1, 0)
_UTF8: Final = 4
"""The most bytes of a character in UTF-8. In a wide string it is two units of 4 bytes."""


class Wires:
    """The wires of messages. Those of nested messages come first, so ask in topological order."""

    def __init__(self) -> None:
        self._sizes: dict[str, _Size] = {}
        self._layouts: dict[str, _Layout | None] = {}
        self._elements: dict[str, tuple[int, int]] = {}

    def of(self, message: Message, extents: Extents) -> Wire:
        """The wire of a message; `extents` are those of its registry."""
        planned = plan(message, extents)
        instructions = [instruction for group in planned.groups for instruction in group]
        own = plan_calls(message, extents)
        steps, own_steps = _Writer().steps(instructions, _START), _Writer().steps(own, _ANYWHERE)
        self._sizes[message.type_name] = self._sum(own_steps)
        self._layouts[message.type_name] = self._layout(message)
        size = self._sum(steps)
        least, start_align = self._elements[message.type_name] = self._element(message)
        return Wire(
            fixed=size.fixed,
            plain=self._layouts[message.type_name] is not None,
            align=max(1, *map(self._align, steps)),
            min_size=size.least,
            max_size=size.most,
            min_element_size=least,
            start_align=start_align,
            steps=steps,
            own=own_steps,
        )

    def _align(self, step: Step) -> int:
        inner = self._sizes[step.type_name].align if step.kind == "call" and step.type_name else 1
        items = (item.size for item in step.items)
        return max(step.align, step.element_align, inner, *items, *map(self._align, step.steps))

    def _sum(self, steps: Sequence[Step]) -> _Size:
        sizes = [self._size(step) for step in steps]
        most = [size.most for size in sizes]
        return _Size(
            fixed=all(size.fixed for size in sizes),
            least=sum(size.least for size in sizes),
            most=None if None in most else sum(size or 0 for size in most),
            align=max(map(self._align, steps)),
        )

    def _size(self, step: Step) -> _Size:
        match step.kind:
            case "run":
                content = _Size(True, step.size, step.size)
            case "text":
                content = _Size(False, COUNT_SIZE, _text_size(step))
            case "values":
                _, padding = _padding(step.element_pad, step.element_align)
                most = None if step.maximum is None else step.maximum * (step.element_size or 0)
                content = _Size(False, COUNT_SIZE, None if most is None else COUNT_SIZE + padding + most)
            case "texts":
                each, count = _text_size(step), step.count if step.count is not None else step.maximum
                most = None if each is None or count is None else count * (each + COUNT_SIZE - 1) + COUNT_SIZE
                content = _Size(False, COUNT_SIZE * (step.count or 1), most)
            case "repeat":
                content = self._repeated(step)
            case "call":
                assert step.type_name is not None, "of what is called"
                content = self._sizes[step.type_name]
        before, before_most = _padding(step.pad, step.align)
        most = None if content.most is None else content.most + before_most
        return replace(content, least=content.least + before, most=most)

    def _repeated(self, step: Step) -> _Size:
        count = step.count if step.count is not None else step.maximum
        prefix = 0 if step.count is not None else COUNT_SIZE
        most: int | None
        if step.stride is not None:
            before, before_most = _padding(step.element_pad, step.element_align)
            fixed, least, most = True, step.stride, step.stride
        else:
            body = self._sum(step.steps)
            before = before_most = 0
            fixed, least, most = body.fixed, body.least, body.most
        return _Size(
            fixed=fixed and step.count is not None,
            least=prefix + (before + least * step.count if step.count is not None else 0),
            most=None if count is None or most is None else prefix + before_most + most * count,
        )

    def _element(self, message: Message) -> tuple[int, int]:
        """The least size of the values of a message, and the alignment of the first of them."""
        fields = [self._element_of(field.type) for field in message.fields] or [(1, 1)]
        return sum(size for size, _ in fields), fields[0][1]

    def _element_of(self, type_: FieldType) -> tuple[int, int]:
        element = element_of(type_)
        if element is not type_ and not isinstance(type_, Array):
            return COUNT_SIZE, COUNT_SIZE
        match element:
            case BasicType(name):
                size = align = NUMBERS[name].size
            case NamespacedType():
                size, align = self._elements[element.type_name]
            case _:
                size = align = COUNT_SIZE
        return size * (type_.size if isinstance(type_, Array) else 1), align

    def _layout(self, message: Message) -> _Layout | None:
        """The layout of a C structure with these fields, if the bytes on the wire are the same."""
        offset, align = 0, 1
        for field in message.fields:
            found = self._layout_of(field.type)
            if found is None:
                return None
            padded = offset + -offset % found.entry
            if padded % found.align:
                return None  # C aligns a structure by its largest member, CDR by its first
            offset, align = padded + found.size, max(align, found.align)
        if not message.fields:
            return _Layout(1, 1, 1)
        first = self._layout_of(message.fields[0].type)
        assert first is not None, "it was looked at above"
        return None if offset % align else _Layout(first.entry, align, offset)

    def _layout_of(self, type_: FieldType) -> _Layout | None:
        element = element_of(type_)
        if element is not type_ and not isinstance(type_, Array):
            return None
        count = type_.size if isinstance(type_, Array) else 1
        match element:
            case BasicType(name):
                size = NUMBERS[name].size
                return _Layout(size, size, size * count)
            case NamespacedType():
                nested = self._layouts[element.type_name]
                return None if nested is None else replace(nested, size=nested.size * count)
            case _:
                return None


@dataclass(frozen=True, slots=True)
class _Size:
    """The limits of a number of bytes, and the largest alignment in them."""

    fixed: bool
    least: int
    most: int | None
    align: int = 1


@dataclass(frozen=True, slots=True)
class _Layout:
    """The layout of a value in memory: the alignments of its first part and of all, and its size in bytes."""

    entry: int
    align: int
    size: int


def _padding(pad: int | None, align: int) -> tuple[int, int]:
    return (0, align - 1) if pad is None else (pad, pad)


def _text_size(step: Step) -> int | None:
    if step.text_maximum is None:
        return None
    if step.wide:
        return COUNT_SIZE + 8 * step.text_maximum
    return COUNT_SIZE + _UTF8 * step.text_maximum + 1


class _Writer:
    """Turns instructions into steps; `_paths` leads from a message, by its number, to each one inside it."""

    def __init__(self) -> None:
        self._positions = Positions(pads_texts=False)
        self._paths: dict[int, tuple[str, ...]] = {0: ()}
        self._position = _START
        self._steps: list[Step] = []
        self._items: list[Item] = []
        self._run: tuple[int, int | None] = 1, 0
        self._size = 0
        self._last = 0

    def steps(self, instructions: Iterable[Instruction], start: Alignment) -> tuple[Step, ...]:
        """The steps of these instructions, for a message or an element that begins at `start`."""
        outer = self._steps, self._items, self._position
        self._steps, self._items, self._position = [], [], start
        for instruction in instructions:
            self._instruction(instruction)
        self._end_run()
        found = tuple(self._steps)
        self._steps, self._items, self._position = outer
        return found

    def _instruction(self, instruction: Instruction) -> None:
        match instruction:
            case Run(items):
                for item in items:
                    self._item(item)
            case Values(slot, type_, Count(size=int(size))):
                self._value(self._path(slot), type_, size)
            case Values(slot, type_, count):
                size = NUMBERS[type_].size
                position = self._position.aligned(COUNT_SIZE).advanced(COUNT_SIZE)
                self._add(
                    Step(
                        "values",
                        self._path(slot),
                        COUNT_SIZE,
                        self._pad(COUNT_SIZE),
                        primitive=PRIMITIVES[type_],
                        maximum=count.maximum,
                        element_size=size,
                        element_align=size,
                        element_pad=_pad(position, size),
                    ),
                    instruction,
                )
            case Text(slot, maximum, wide):
                pad = self._pad(COUNT_SIZE)
                step = Step("text", self._path(slot), COUNT_SIZE, pad, wide=wide, text_maximum=maximum)
                self._add(step, instruction)
            case Texts(slot, maximum, wide, count):
                self._add(
                    Step(
                        "texts",
                        self._path(slot),
                        COUNT_SIZE,
                        self._pad(COUNT_SIZE),
                        wide=wide,
                        text_maximum=maximum,
                        count=count.size,
                        maximum=count.maximum,
                    ),
                    instruction,
                )
            case Repeat():
                self._repeat(instruction)
            case Call(message, type_):
                step = Step("call", self._paths[message], 1, 0, type_name=type_.type_name)
                self._add(step, instruction)
            case _:
                assert_never(instruction)

    def _repeat(self, repeat: Repeat) -> None:
        path, count = self._path(repeat.slot), repeat.count
        self._end_run()
        align = COUNT_SIZE if count.size is None else 1
        pad = self._pad(align)
        start = self._position
        if count.size is None:
            start = start.aligned(COUNT_SIZE).advanced(COUNT_SIZE)
        tile = tile_of(repeat.body)
        self._paths[repeat.message] = ()
        self._last = repeat.message
        if tile is None:
            element_align = 1
            element_pad: int | None = 0
            body = self.steps(repeat.body, self._positions.head(repeat, start))
        else:
            # Elements stand without padding between them: the first one has all there is.
            element_align, element_pad = tile.alignment, _pad(start, tile.alignment)
            body = self.steps(repeat.body, Alignment(tile.alignment, 0))
        self._add(
            Step(
                "repeat",
                path,
                align,
                pad,
                count=count.size,
                maximum=count.maximum,
                element_align=element_align,
                element_pad=element_pad,
                type_name=repeat.type.type_name,
                stride=tile.size if tile else None,
                steps=body,
            ),
            repeat,
        )

    def _item(self, item: program.Item) -> None:
        match item:
            case Enter(slot, message, _):
                self._paths[message] = self._path(slot)
                self._last = message
            case Blank():
                self._value(self._paths[self._last], "uint8", None, placeholder=True)
            case program.Array(slot, type_, size):
                self._value(self._path(slot), type_, size)
            case program.Value(slot, type_):
                self._value(self._path(slot), type_, None)

    def _value(
        self, path: tuple[str, ...], type_: BasicTypeName, count: int | None, *, placeholder: bool = False
    ) -> None:
        size = NUMBERS[type_].size
        pad = self._pad(size)
        if not self._items or pad is None:
            self._end_run()
            self._run, offset = (size, pad), 0
        else:
            offset = self._size + pad
        self._items.append(Item(path, PRIMITIVES[type_], offset, size, count, placeholder))
        whole = size * (1 if count is None else count)
        self._size = offset + whole
        self._position = self._position.aligned(size).advanced(whole)

    def _end_run(self) -> None:
        if self._items:
            self._steps.append(Step("run", (), *self._run, size=self._size, items=tuple(self._items)))
            self._items = []

    def _add(self, step: Step, instruction: Instruction) -> None:
        self._end_run()
        self._steps.append(step)
        self._position = self._positions.after(instruction, self._position, 1)

    def _path(self, slot: program.Slot) -> tuple[str, ...]:
        return (*self._paths[slot.message], slot.name)

    def _pad(self, align: int) -> int | None:
        return _pad(self._position, align)


def _pad(position: Alignment, align: int) -> int | None:
    """The padding to an alignment, None where it is not always the same."""
    return -position.remainder % align if position.modulus >= align else None

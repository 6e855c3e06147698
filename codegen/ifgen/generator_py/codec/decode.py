"""Python text that deserialises the instructions of a program, one after another.

What makes it safe: the position `p` only grows, each fixed run is unpacked by a `struct.Struct` that checks
the length of its buffer, each string reads the byte at its end, a count is compared with what is left before
a loop over it, and whatever was only sliced is checked by one comparison at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.body import Constants, Reference
from ifgen.generator_py.codec.reads import (
    BLANK,
    Piece,
    Reads,
    count_piece,
    number_piece,
    run_format,
    tuple_target,
)
from ifgen.generator_py.codec.statements import (
    POSITION,
    Assign,
    Do,
    Positioned,
    product,
    slot_text,
    variable,
)
from ifgen.wire.positions import Positions, Tile, smallest_size, tile_of
from ifgen.wire.program import (
    NUMBERS,
    Array,
    Blank,
    Call,
    Count,
    Enter,
    Instruction,
    Item,
    Repeat,
    Run,
    Text,
    Texts,
    Value,
    Values,
)


class Decoder:
    """Reads what instructions say, in one function.

    `may_view` means that the function has a parameter `views`, which makes the value of a numeric sequence of
    bytes instead of an array.array, if there is one.
    """

    def __init__(
        self, source: Reads, constants: Constants, reference: Reference, *, may_view: bool = False
    ) -> None:
        self._in = source
        self._body = source.body
        self._constants = constants
        self._runtime = constants.runtime
        self._reference = reference
        self._may_view = may_view
        self._positions = Positions(pads_texts=False)
        self._at = source.alignment

    def read_all(self, instructions: Sequence[Instruction]) -> None:
        """Read the instructions, and check that what was sliced was there."""
        self._read(instructions)
        self._in.flush()
        if self._in.unchecked:
            self._body.refuse([Positioned("p > len(data)")])

    def create(self, message: int, type_: NamespacedType) -> None:
        """Make an empty message."""
        create = self._constants.name(f"{self._runtime('creator')}({self._reference(type_)})")
        self._body.assign(variable(message), f"{create}()")

    def _read(self, instructions: Sequence[Instruction]) -> None:
        for instruction in instructions:
            end = self._positions.after(instruction, self._at, following=1)
            self._instruction(instruction)
            self._at = end
            if not isinstance(instruction, Run):  # which may be pending
                self._in.alignment = end

    def _instruction(self, instruction: Instruction) -> None:
        match instruction:
            case Run(items):
                for item in items:
                    self._item(item)
            case Text(wide=True):
                self._wide_text(instruction)
            case Text():
                self._text(instruction)
            case Values(type=("boolean" | "octet" | "char")):
                self._flags(instruction)
            case Values():
                self._numbers(instruction)
            case Texts():
                self._texts(instruction)
            case Repeat():
                self._messages(instruction)
            case Call():
                self._call(instruction)
            case _:
                assert_never(instruction)

    def _item(self, item: Item) -> None:
        match item:
            case Enter():
                self._enter(item)
            case Value(slot, "char"):
                character = self._body.name("c")
                self._in.expect(Piece("B", 1, 1, character))
                self._in.flush()
                self._body.assign(slot_text(slot), f"chr({character})")
            case Value() | Blank():
                self._in.expect(_piece(item))
            case Array():
                self._in.expect_array(item)
            case _:
                assert_never(item)

    def _enter(self, nested: Enter) -> None:
        self.create(nested.message, nested.type)
        self._body.assign(slot_text(nested.slot), variable(nested.message))

    def _wide_text(self, step: Text) -> None:
        self._in.flush()
        self._in.enter_variable_part()
        self._take(step, f"{self._runtime('wstring')}(data, p, {step.maximum})")

    def _take(self, step: Text | Texts, call: str) -> None:
        """Store what a function reads at `p`, and move on to where it ends."""
        self._body.assign(Positioned(f"{slot_text(step.slot)}, p"), Positioned(call))

    def _text(self, step: Text) -> None:
        text = self._body.name("s")
        span = self._text_span()
        self._body.assign(f"{slot_text(step.slot)} = {text}", Positioned("data[" + span + "].decode()"))
        refusals = [Positioned("data[p - 1]"), f'"\\0" in {text}']
        if step.maximum is not None:
            refusals.append(f"len({text}) > {step.maximum}")
        self._body.refuse(refusals)
        self._in.offset = None
        self._in.note_check()

    def _text_span(self) -> str:
        """Where the characters of a string are; `p` moves to its end."""
        if self._in.in_loop and not self._in.has_pending:
            self._in.uses_words = True
            aligned = self._in.alignment.is_aligned(4)
            self._body.assign("q", Positioned("p + 4" if aligned else "p + 7 & -4"))
            self._body.assign(POSITION, "q + words[(q >> 2) - 1]")
            return "q : p - 1"
        size = self._body.name("n")
        self._in.expect(count_piece(size))
        self._in.flush()
        if self._in.offset is None:
            return f"p : (p := p + {size}) - 1"
        self._body.place(f"{self._in.offset} + {size}")
        return f"{self._in.offset} : p - 1"

    # Arrays and sequences

    def _count(self, count: Count) -> str | int:
        """Read the count of a sequence and check its bound; of an array, the size."""
        if count.size is not None:
            self._in.flush()
            return count.size
        name = self._body.name("n")
        self._in.expect(count_piece(name))
        self._in.flush()
        if count.maximum is not None:
            self._body.refuse([f"{name} > {count.maximum}"])
        return name

    def _texts(self, step: Texts) -> None:
        count = self._count(step.count)
        self._in.enter_variable_part()
        read = self._runtime("wstrings" if step.wide else "strings")
        self._take(step, f"{read}(data, p, {count}, {step.maximum})")

    def _flags(self, step: Values) -> None:
        """Booleans, octets and characters are lists."""
        count = self._count(step.count)
        self._in.enter_variable_part()
        is_text = step.type == "char"
        format_ = "s" if is_text else NUMBERS[step.type].format
        layout = f'"{count}{format_}"' if isinstance(count, int) else f'f"{{{count}}}{format_}"'
        values = f"{self._runtime('unpack_from')}({layout}, data, p)"
        if is_text:
            values += '[0].decode("latin-1")'
        self._body.assign(slot_text(step.slot), Positioned(f"list({values})"))
        self._body.move(count)

    def _numbers(self, step: Values) -> None:
        number = NUMBERS[step.type]
        count = self._count(step.count)
        if number.size == 8:
            self._in.pad_elements(count)
        elements = self._body.name("a")
        self._in.enter_variable_part()
        slot, part = slot_text(step.slot), self._slice(product(count, number.size))
        new = Assign(f"{slot} = {elements}", f'{self._runtime("array")}("{number.typecode}")')
        fill = Do(Positioned(f"{elements}.frombytes(" + part + ")"))
        if self._may_view:
            view = Assign(slot, Positioned(f'views("{number.typecode}", {count}, ' + part + ")"))
            self._body.choose("views", [view], [new, fill])
        else:
            self._body.assign(*new)
            self._body.do(*fill)

    def _slice(self, size: str | int) -> str:
        """So many bytes of the input, which may be fewer; `p` moves on."""
        self._in.uses_view = self._in.unchecked = True
        return f"view[p : (p := p + {size})]"

    # Messages in arrays and sequences

    def _messages(self, step: Repeat) -> None:
        count = self._count(step.count)
        elements = self._body.name("a")
        tile = tile_of(step.body)
        if tile is None:
            self._each_message(step, count, elements)
        else:
            self._unpacked_messages(step, count, elements, tile)

    def _unpacked_messages(self, step: Repeat, count: str | int, elements: str, tile: Tile) -> None:
        """Elements of one fixed layout, unpacked one after another."""
        if step.count.size is not None:
            self._in.pad(tile.alignment)
        elif tile.alignment == 8:
            self._in.pad_elements(count)
        self._in.enter_variable_part()
        self._body.assign(f"{slot_text(step.slot)} = {elements}", "[]")
        run = [_piece(item) for item in tile.items if not isinstance(item, Enter)]
        each = self._constants.layout("each_unpacker", run_format(run, 0)[0])
        with self._body.each("values", Positioned(f"{each}({self._slice(product(count, tile.size))})")):
            self.create(step.message, step.type)
            for item in tile.items:
                if isinstance(item, Enter):
                    self._enter(item)
            if targets := [piece.value for piece in run if piece.value is not None]:
                self._body.assign(tuple_target(targets), "values")
            self._body.do(f"{elements}.append({variable(step.message)})")

    def _each_message(self, step: Repeat, count: str | int, elements: str) -> None:
        """Elements of varying layout, one after another."""
        self._in.enter_variable_part()
        if step.count.size is None:
            needed = product(count, smallest_size(step.body))
            self._body.refuse([Positioned(f"{needed} > len(data) - p")])
        self._body.assign(f"{slot_text(step.slot)} = {elements}", "[]")
        self._in.alignment = self._at = self._positions.head(step, self._in.alignment)
        outside, self._in.in_loop = self._in.in_loop, True
        with self._body.each("_", f"{self._runtime('repeat')}(None, {count})"):
            self.create(step.message, step.type)
            self._read(step.body)
            self._in.flush()
            self._body.do(f"{elements}.append({variable(step.message)})")
        self._in.in_loop = outside

    def _call(self, step: Call) -> None:
        """A message that reads itself."""
        self._in.flush()
        self._in.enter_variable_part()
        self._in.uses_words = True
        read = self._constants.name(f"{self._runtime('reader_of')}({self._reference(step.type)})")
        self._body.assign(POSITION, Positioned(f"{read}({variable(step.message)}, data, view, words, p)"))


def _piece(item: Value | Blank) -> Piece:
    return BLANK if isinstance(item, Blank) else number_piece(item.type, slot_text(item.slot))

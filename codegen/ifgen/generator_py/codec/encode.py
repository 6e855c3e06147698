"""Python text that serialises a message: `_serialize_Name(m)`, a straight line over its slots.

Its form. Each part was measured (benchmarks/codec.py):

* what has a fixed layout is packed by one precomputed `struct.Struct` a run; where the position before it is
  only known in part, by one from a table, chosen by the position;
* strings come from a memory of their wire forms, padded to 4 bytes where that is what follows anyway; one
  between two runs is packed with them, by a Struct for its size;
* arrays go to `bytes.join` unchanged, so that a blob is copied once.

Only values of exactly the expected kind stay on this path. Anything else raises something, and the function
starts over with `encode_any`, which accepts what can be accepted and names the field otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple, assert_never

from ifgen.definition.types import BasicTypeName
from ifgen.generator_py.codec.body import Constants, Reference
from ifgen.generator_py.codec.parts import Parts, Wire
from ifgen.generator_py.codec.reads import BLANK, Piece, count_piece, number_piece
from ifgen.generator_py.codec.statements import POSITION, Positioned, product, slot_text, variable
from ifgen.wire.positions import (
    Alignment,
    Positions,
    Tile,
    following_alignments,
    tile_of,
)
from ifgen.wire.program import (
    NUMBERS,
    Array,
    Blank,
    Call,
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

_LARGE_ARRAY: Final = 256
_WIRES: Final[dict[BasicTypeName, str]] = {
    "boolean": "booleans_wire",
    "octet": "octets_wire",
    "char": "characters_wire",
}


class Encoder:
    """Writes instructions into the parts of one function."""

    def __init__(self, out: Parts, constants: Constants, reference: Reference) -> None:
        self._out = out
        self._name = out.body.name
        self._constants = constants
        self._runtime = constants.runtime
        self._reference = reference
        self._positions = Positions(pads_texts=True)
        self._end = out.alignment  # after the instruction that is being written

    def write(self, instructions: Sequence[Instruction], following: int) -> None:
        """Write the instructions; `following` is the alignment of what comes after them, 1 at the end."""
        for instruction, after in zip(
            instructions, following_alignments(instructions, following), strict=True
        ):
            self._end = self._positions.after(instruction, self._end, after)
            self._instruction(instruction, after)

    def _instruction(self, instruction: Instruction, following: int) -> None:
        match instruction:
            case Run(items):
                for item in items:
                    self._item(item)
            case Text():
                self._text(instruction, following)
            case Values(type=("boolean" | "octet" | "char")):
                self._flags(instruction)
            case Values():
                self._numbers(instruction)
            case Texts():
                self._texts(instruction, following)
            case Repeat():
                self._messages(instruction, following)
            case Call():
                self._call(instruction)
            case _:
                assert_never(instruction)

    def _item(self, item: Item) -> None:
        match item:
            case Enter():
                self._out.refuse(self._class_check(item).fails)
            case Blank():
                self._out.expect(BLANK)
            case Value():
                checks, value = checked_value(item, self._name)
                self._out.refuse(*(check.fails for check in checks))
                self._out.expect(number_piece(item.type, value))
            case Array():
                self._array(item)
            case _:
                assert_never(item)

    def _class_check(self, nested: Enter) -> ClassCheck:
        return ClassCheck(
            f"({variable(nested.message)} := {slot_text(nested.slot)})", self._reference(nested.type)
        )

    def _text(self, step: Text, following: int) -> None:
        value = slot_text(step.slot)
        if step.maximum is not None:
            name = self._name("s")
            self._out.refuse(f"len({name} := {value}) > {step.maximum}")
            value = name
        if step.wide:
            self._out.align(4)
            self._out.add_bytes(f"{self._runtime('wstring_wire')}({value})", self._end)
        else:
            self._out.add_text(Wire(value, self._positions.is_padded(following)))

    # Arrays and sequences

    def _array(self, step: Array) -> None:
        number = NUMBERS[step.type]
        elements, total = self._name("a"), step.size * number.size
        loaded = f"({elements} := {slot_text(step.slot)})"
        self._out.refuse(f"{loaded}.dtype is not {self._runtime('numeric')}.{number.dtype}")
        if total > _LARGE_ARRAY:
            self._out.refuse(f"{elements}.nbytes != {total}")
            self._out.align(number.size)
            self._out.add_part(elements)
            self._out.jump(total, self._out.alignment.advanced(total))
            return
        packed = self._name("b")
        self._out.refuse(f"len({packed} := {elements}.tobytes()) != {total}")
        self._out.expect(Piece(f"{total}s", number.size, total, packed))

    def _counted(self, step: Values | Texts | Repeat) -> str:
        """Load the collection, check and write its count; the name of the collection."""
        elements = self._name("a")
        loaded = f"({elements} := {slot_text(step.slot)})"
        if isinstance(step, Values) and (typecode := NUMBERS[step.type].typecode):
            self._out.refuse(f'{loaded}.typecode != "{typecode}"')
        else:
            self._out.refuse(ClassCheck(loaded, "list").fails)
        if step.count.size is not None:
            self._out.refuse(f"len({elements}) != {step.count.size}")
            return elements
        if step.count.maximum is not None:
            self._out.refuse(f"len({elements}) > {step.count.maximum}")
        self._out.expect(count_piece(f"len({elements})"))
        return elements

    def _flags(self, step: Values) -> None:
        """Booleans, octets and characters are lists."""
        elements = self._counted(step)
        self._out.flush()
        self._out.add_bytes(f"{self._runtime(_WIRES[step.type])}({elements})", self._end)

    def _numbers(self, step: Values) -> None:
        number = NUMBERS[step.type]
        elements = self._counted(step)
        self._out.flush()
        if number.size == 8:
            self._align_elements(elements)
        self._out.add_part(elements)
        self._out.jump(product(f"len({elements})", number.size), self._end)

    def _align_elements(self, elements: str) -> None:
        """Pad a sequence of 8-byte elements after its count; an empty one is not padded."""
        if not self._out.alignment.is_aligned(8):
            # A numpy array, which a field of a decoded message may hold, has no truth: len() it is.
            needed = f"p & 4 and len({elements})" if self._out.is_tracked else f"len({elements})"
            padding = f'{self._runtime("four_zeros")} if {needed} else b""'
            self._out.add_bytes(Positioned(padding) if self._out.is_tracked else padding, Alignment(4, 0))

    def _texts(self, step: Texts, following: int) -> None:
        elements = self._counted(step)
        if step.maximum is not None:
            self._out.refuse(f"{self._runtime('any_longer')}({elements}, {step.maximum})")
        self._out.align(4)
        kind = "w" if step.wide else "padded_" if self._positions.is_padded(following) else ""
        wire = self._runtime(f"{kind}strings_wire")
        self._out.add_bytes(f"{wire}({elements})", self._end)

    # Messages in arrays and sequences

    def _messages(self, step: Repeat, following: int) -> None:
        elements = self._counted(step)
        tile = tile_of(step.body)
        if tile is None:
            self._each_message(step, elements, following)
        else:
            self._packed_messages(step, elements, tile)

    def _packed_messages(self, step: Repeat, elements: str, tile: Tile) -> None:
        """Elements of one fixed layout: a list of packed ones, without those of a wrong kind."""
        if step.count.size is not None:
            self._out.align(tile.alignment)
        else:
            self._out.flush()
            if tile.alignment == 8:
                self._align_elements(elements)
        checks = [ClassCheck(variable(step.message), self._reference(step.type))]
        run: list[Piece] = []
        for item in tile.items:
            match item:
                case Enter():
                    checks.append(self._class_check(item))
                case Value():
                    more, value = checked_value(item, self._name)
                    checks += more
                    run.append(number_piece(item.type, value))
                case Blank():
                    run.append(BLANK)
        packed, parts = self._out.packed(run, 0), self._name("parts")
        accepted = " and ".join(check.holds for check in checks)
        loop = f"for {variable(step.message)} in {elements} if {accepted}"
        self._out.body.assign(parts, f"[{packed} {loop}]")
        self._out.body.refuse([f"len({parts}) != len({elements})"])
        self._out.add_part(parts, is_list=True)
        count = f"len({elements})" if step.count.size is None else step.count.size
        self._out.jump(product(count, tile.size), self._end)

    def _each_message(self, step: Repeat, elements: str, following: int) -> None:
        """Elements of varying layout: a loop that appends their parts to `out`."""
        self._out.flush()
        self._out.emit()
        head, end = self._positions.head(step, self._out.alignment), self._end
        self._forget_down_to(head)
        self._end = head
        element = variable(step.message)
        with self._out.body.each(element, elements):
            self._out.refuse(ClassCheck(element, self._reference(step.type)).fails)
            self.write(step.body, self._positions.between(step))
            self._out.flush()
            self._out.emit()
            self._forget_down_to(head)
        last = step.body[-1]
        if isinstance(last, Text) and self._positions.is_cut(step, following):
            self._cut_padding(last, elements)
        self._end = end

    def _call(self, step: Call) -> None:
        """A message that writes itself."""
        self._out.flush()
        self._out.emit()
        write = self._constants.name(f"{self._runtime('writer_of')}({self._reference(step.type)})")
        call = f"{write}({variable(step.message)}, out, " + self._out.position + ")"
        self._out.body.assign(POSITION, Positioned(call) if self._out.is_tracked else call)
        self._out.alignment = self._end

    def _forget_down_to(self, head: Alignment) -> None:
        """Know as little about the position as at the head of the loop; `p` begins where it is needed."""
        if head.modulus < self._out.needed and not self._out.is_tracked:
            self._out.body.place(str(self._out.alignment.remainder))
        self._out.alignment = head

    def _cut_padding(self, last: Text, elements: str) -> None:
        self._forget_down_to(Alignment(1, 0))
        text = slot_text(last.slot)
        with self._out.body.when(elements):
            self._out.body.do(f"out[-1] = {self._runtime('wire')}[{text}]")
            self._out.body.move(f"len(out[-1]) - len({self._runtime('padded_wire')}[{text}])")


class ClassCheck(NamedTuple):
    """Whether a value is exactly of a class."""

    value: str
    class_name: str

    @property
    def fails(self) -> str:
        """The condition for another class."""
        return f"{self.value}.__class__ is not {self.class_name}"

    @property
    def holds(self) -> str:
        """The condition for this class."""
        return f"{self.value}.__class__ is {self.class_name}"


_CLASSES: dict[BasicTypeName, str] = {"boolean": "bool", "float": "float", "double": "float"}


def checked_value(value: Value, name: Callable[[str], str]) -> tuple[list[ClassCheck], str]:
    """The checks of a basic value, and the value to pack. `struct` itself checks integers and octets."""
    slot = slot_text(value.slot)
    if value.type == "char":
        return [], f'{slot}.encode("latin-1")'
    if value.type not in _CLASSES:
        return [], slot
    variable = name("x")
    return [ClassCheck(f"({variable} := {slot})", _CLASSES[value.type])], variable

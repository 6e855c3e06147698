"""Sizes, alignments and positions, as far as they follow from the instructions of a program."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import gcd
from typing import Final, NamedTuple, assert_never

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


class Alignment(NamedTuple):
    """The knowledge about a position: it is `remainder` modulo `modulus` (1, 2, 4 or 8)."""

    modulus: int
    remainder: int

    def advanced(self, size: int) -> Alignment:
        """The position `size` bytes on."""
        return Alignment(self.modulus, (self.remainder + size) % self.modulus)

    def aligned(self, alignment: int) -> Alignment:
        """The position after padding to `alignment`."""
        if alignment > self.modulus:
            return Alignment(alignment, 0)
        return self.advanced(-self.remainder % alignment)

    def after(self, spaces: Iterable[tuple[int, int]]) -> Alignment:
        """The position after values of these alignments and sizes, with the padding before each."""
        modulus, remainder = self.modulus, self.remainder
        for alignment, size in spaces:
            if alignment > modulus:
                modulus, remainder = alignment, 0
            remainder = (remainder + -remainder % alignment + size) % modulus
        return Alignment(modulus, remainder)

    def either(self, other: Alignment) -> Alignment:
        """The knowledge that holds for both positions."""
        modulus = gcd(self.modulus, other.modulus, self.remainder - other.remainder)
        return Alignment(modulus, self.remainder % modulus)

    def is_aligned(self, alignment: int) -> bool:
        """Whether no padding can be needed before a value of this alignment."""
        return self.modulus >= alignment and self.remainder % alignment == 0


COUNT_SIZE = 4
"""Bytes of a count or of the length of a string, and their alignment."""
_SPACES: Final = {name: (number.size, number.size) for name, number in NUMBERS.items()}


def space_of(item: Item) -> tuple[int, int]:
    """The alignment and the size of an item of a run."""
    match item:
        case Value():
            return _SPACES[item.type]
        case Enter():
            return 1, 0
        case Blank():
            return 1, 1
        case Array():
            size, _ = _SPACES[item.type]
            return size, size * item.size
        case _:
            assert_never(item)


def entry_alignment(instructions: Sequence[Instruction], end: int = 1) -> int:
    """The alignment of the first thing on the wire; `end` if there is none."""
    return next((entry for entry in map(_entry, instructions) if entry is not None), end)


def following_alignments(instructions: Sequence[Instruction], end: int) -> list[int]:
    """For each instruction the alignment of what comes after it; `end` is that of what comes after all."""
    found: list[int] = []
    for instruction in reversed(instructions):
        found.append(end)
        entry = _entry(instruction)
        end = end if entry is None else entry
    return found[::-1]


def _entry(instruction: Instruction) -> int | None:
    match instruction:
        case Run(items):
            return next((space_of(item)[0] for item in items if not isinstance(item, Enter)), None)
        case Call():  # which pads
            return 1
        case Values(type=type_, count=Count(size=int())):
            return NUMBERS[type_].size
        case Repeat(count=Count(size=int()), body=body):
            return entry_alignment(body)
        case Text() | Values() | Texts() | Repeat():
            return COUNT_SIZE
        case _:
            assert_never(instruction)


def largest_alignment(instructions: Sequence[Instruction]) -> int:
    """The largest alignment of anything in the instructions; of what is called nothing is known."""
    return max(map(_largest, instructions), default=1)


def _largest(instruction: Instruction) -> int:
    match instruction:
        case Run(items):
            return max(space_of(item)[0] for item in items)
        case Call():
            return 8
        case Values(type=type_, count=Count(size=size)):
            return max(NUMBERS[type_].size, COUNT_SIZE if size is None else 1)
        case Repeat(count=Count(size=size), body=body):
            return max(largest_alignment(body), COUNT_SIZE if size is None else 1)
        case Text() | Texts():
            return COUNT_SIZE
        case _:
            assert_never(instruction)


def smallest_size(instructions: Sequence[Instruction]) -> int:
    """A lower limit for the bytes that the instructions take, paddings not counted; at least 1."""
    return sum(map(_smallest, instructions))


def _smallest(instruction: Instruction) -> int:
    match instruction:
        case Run(items):
            return sum(space_of(item)[1] for item in items)
        case Call():
            return 1
        case Values(type=type_, count=Count(size=int(size))):
            return NUMBERS[type_].size * size
        case Texts(count=Count(size=int(size))):
            return COUNT_SIZE * size
        case Repeat(count=Count(size=int(size)), body=body):
            return smallest_size(body) * size
        case Text() | Values() | Texts() | Repeat():
            return COUNT_SIZE
        case _:
            assert_never(instruction)


@dataclass(frozen=True, slots=True)
class Tile:
    """An element with the same layout throughout an array or a sequence, without padding between elements."""

    items: tuple[Enter | Value | Blank, ...]
    alignment: int
    size: int


def tile_of(body: Sequence[Instruction]) -> Tile | None:
    """The body of a `Repeat` as a tile, or None if it is not one.

    A tile holds only values that `struct` packs unchanged, the first of them has the largest alignment, and
    the size is a multiple of that alignment.
    """
    match body:
        case [Run(items)]:
            fit = tuple(item for item in items if not isinstance(item, Array) and not _is_char(item))
            alignment, size = entry_alignment(body), 0
            if len(fit) < len(items) or alignment < largest_alignment(body):
                return None
            for its_alignment, its_size in map(space_of, items):
                size += -size % its_alignment + its_size
            return None if size % alignment else Tile(fit, alignment, size)
        case _:
            return None


def _is_char(item: Item) -> bool:
    return isinstance(item, Value) and item.type == "char"


class Positions:
    """The knowledge about positions between instructions.

    `pads_texts`: an encoder pads a string for a 4-aligned successor at once, so it knows the position after
    the padding. A decoder knows nothing after a string.
    """

    def __init__(self, *, pads_texts: bool) -> None:
        self._pads_texts = pads_texts
        # Without this memory, each level of nested loops would multiply the work.
        self._heads: dict[tuple[int, Alignment], Alignment] = {}

    def after(self, instruction: Instruction, start: Alignment, following: int) -> Alignment:
        """The position after an instruction. `following` is the alignment of the next value, 1 at the end."""
        match instruction:
            case Run(items):
                return start.after(map(space_of, items))
            case Text(wide=wide) | Texts(wide=wide):
                return Alignment(4, 0) if wide or self.is_padded(following) else Alignment(1, 0)
            case Values(type=type_, count=Count(size=size)):
                return Alignment(min(NUMBERS[type_].size, 4), 0) if size is None else start.advanced(size)
            case Repeat():
                return self._after_elements(instruction, start, following)
            case Call():
                return Alignment(1, 0)
            case _:
                assert_never(instruction)

    def is_padded(self, following: int) -> bool:
        """Whether a string is padded if this is the alignment of what follows it."""
        return self._pads_texts and following >= COUNT_SIZE

    def head(self, repeat: Repeat, start: Alignment) -> Alignment:
        """The knowledge at the head of a loop: it holds before the first element and after each.

        Each `Repeat` of a program has its own number, which is therefore the key of the memory.
        """
        known = repeat.message, start
        if known not in self._heads:
            end = start
            following = following_alignments(repeat.body, self.between(repeat))
            for instruction, after in zip(repeat.body, following, strict=True):
                end = self.after(instruction, end, after)
            settled = start.either(end)
            self._heads[known] = start if settled == start else self.head(repeat, settled)
        return self._heads[known]

    def between(self, repeat: Repeat) -> int:
        """The alignment that elements are padded to: of the next element, if they end with a string."""
        ends_with_text = isinstance(repeat.body[-1], Text) and not repeat.body[-1].wide
        entry = entry_alignment(repeat.body)
        return entry if ends_with_text and self.is_padded(entry) else 1

    def is_cut(self, repeat: Repeat, following: int) -> bool:
        """Whether the padding after the last element is removed, because nothing after it needs it."""
        return self.is_padded(self.between(repeat)) and not self.is_padded(following)

    def _after_elements(self, repeat: Repeat, start: Alignment, following: int) -> Alignment:
        size, tile = repeat.count.size, tile_of(repeat.body)
        if size is None:
            start = start.after([(COUNT_SIZE, COUNT_SIZE)])
        if tile is None:
            return Alignment(1, 0) if self.is_cut(repeat, following) else self.head(repeat, start)
        if size is None:
            return Alignment(min(tile.alignment, 4), 0)
        return start.after([(tile.alignment, size * tile.size)])

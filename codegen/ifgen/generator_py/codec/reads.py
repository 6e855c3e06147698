"""The reads of a message, in order: runs of values as `struct` unpacks them, and the position between them.

The position is a number as long as nothing of variable length was read, and the variable `p` from then on.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Final, NamedTuple

from ifgen.definition.types import BasicTypeName
from ifgen.generator_py.codec.body import Body, Constants
from ifgen.generator_py.codec.statements import POSITION, Positioned, slot_text
from ifgen.wire.positions import COUNT_SIZE, Alignment
from ifgen.wire.program import NUMBERS, Array

HEADER_SIZE: Final = 4
"""Bytes before the position from which everything is aligned."""


class Piece(NamedTuple):
    """A part of a run: its `struct` format, alignment and size.

    `value` is what to pack or where to unpack to; None for bytes that are only skipped.
    """

    format: str
    alignment: int
    size: int
    value: str | None = None
    is_header: bool = False


HEADER: Final = Piece("I", 1, 0, "256", is_header=True)
"""`00 01 00 00`, plain CDR in little endian; positions are counted from after it."""

BLANK: Final = Piece("x", 1, 1)


def number_piece(type_: BasicTypeName, value: str) -> Piece:
    """A basic value."""
    number = NUMBERS[type_]
    return Piece(number.format, number.size, number.size, value)


def count_piece(value: str) -> Piece:
    """The count of a sequence."""
    return Piece("I", COUNT_SIZE, COUNT_SIZE, value)


def padding_piece(alignment: int) -> Piece:
    """Nothing but the padding before it."""
    return Piece("", alignment, 0)


def after_run(run: Sequence[Piece], start: Alignment) -> Alignment:
    """The knowledge about the position after a run."""
    return start.after([(piece.alignment, piece.size) for piece in run])


def places_of(run: Sequence[Piece], start: int) -> list[int]:
    """Where the pieces of a run begin, from its start, which is this position modulo 8."""
    places: list[int] = []
    position = start
    for piece in run:
        position += -position % piece.alignment
        places.append(position - start)
        position += piece.size
    return places


def run_format(run: Sequence[Piece], start: int) -> tuple[str, int]:
    """The `struct` format and the size, padding included, of a run that starts at this position modulo 8."""
    formats: list[str] = []
    position = start
    for piece in run:
        padding = -position % piece.alignment
        formats += "x" * padding if padding < 3 else [f"{padding}x"]
        formats.append(piece.format)
        position += padding + piece.size
    return _shortened(formats), position - start


def _shortened(formats: list[str]) -> str:
    """Formats in one text: several `d` are `3d`; `72s` twice stays, since its count is a length."""
    text = ""
    for format_, group in groupby(filter(None, formats)):
        times = len(list(group))
        text += f"{times}{format_}" if times > 1 and len(format_) == 1 else format_ * times
    return text


_LARGE_REGION = 1024


class Reads:
    """Collects what is read of a message, or of an element in a loop.

    `offset` is the position as a number, from the start of the input; None where it is `p`. `unchecked` tells
    that bytes were only sliced, and may be fewer than the position says; `in_loop`, that what is checked here
    may never run.
    """

    def __init__(self, constants: Constants, body: Body, alignment: Alignment, *, offset: int | None) -> None:
        self.body = body
        self.alignment = alignment
        self.offset = offset
        self.in_loop = False
        self.unchecked = False
        self.uses_view = False
        self.uses_words = False
        self._constants = constants
        self._header_read = offset is None
        self._run: list[Piece] = []
        self._reached = alignment
        self._arrays: list[tuple[int, Array]] = []

    @property
    def has_pending(self) -> bool:
        """Whether the run has pieces that are not read yet."""
        return bool(self._run)

    def enter_variable_part(self) -> None:
        """Keep the position in `p` from now on."""
        if self.offset is not None:
            self.body.place(str(self.offset))
            self.offset = None

    def pad(self, alignment: int) -> None:
        """Move `p` to the alignment."""
        self.enter_variable_part()
        if self.alignment.modulus < alignment:
            self.body.place(_aligned(alignment))
        else:
            self.body.move(-self.alignment.remainder % alignment)
        self.alignment = self.alignment.aligned(alignment)

    def pad_elements(self, count: str | int) -> None:
        """Move `p` from the count of a sequence to its 8-byte elements; an empty one is not padded."""
        self.enter_variable_part()
        if not self.alignment.is_aligned(8):
            with self.body.when(str(count)):
                self.body.place(_aligned(8))

    def expect(self, piece: Piece) -> None:
        """Add a piece to the run, or begin a new one where the padding before it is not known."""
        if self._run and piece.alignment > self._reached.modulus:
            self.flush()
        if not self._run:
            self._reached = self.alignment
        self._reached = after_run([piece], self._reached)
        self._run.append(piece)

    def expect_array(self, array: Array) -> None:
        """Add a numpy array to the run."""
        number = NUMBERS[array.type]
        size = number.size * array.size
        self.expect(Piece(f"{size}x", number.size, size))
        self._arrays.append((len(self._run) - 1, array))

    def flush(self) -> None:
        """Unpack the pending run at once; the header with the first."""
        if self._header_read and not self._run:
            return
        if self._run and self.offset is None and self._run[0].alignment > self.alignment.modulus:
            self.pad(self._run[0].alignment)
        layout, size = run_format(self._run, self.alignment.remainder)
        targets = [piece.value for piece in self._run if piece.value is not None]
        if self._header_read:
            self._unpack(targets, layout, POSITION if self.offset is None else str(self.offset))
        else:
            self._unpack(["encoding", *targets], f"H2x{layout}", "0")
            self.body.refuse(["encoding != 256"])  # 00 01: plain CDR, little endian
            self._header_read = True
        self._emit_arrays()
        self.alignment = after_run(self._run, self.alignment)
        if self.offset is None:
            self.body.move(size)
        else:
            self.offset += size
        self._run, self._arrays = [], []
        self.note_check()

    def note_check(self) -> None:
        """Note that whatever was sliced so far turned out to be there."""
        if not self.in_loop:
            self.unchecked = False

    def _unpack(self, targets: Sequence[str], layout: str, where: str) -> None:
        values = self._constants.layout("unpacker", layout) + "(data, " + where + ")"
        if isinstance(where, Positioned):
            values = Positioned(values)
        if targets:
            self.body.assign(tuple_target(targets), values)
        else:
            self.body.do(values)

    def _emit_arrays(self) -> None:
        """Give the numpy arrays of the run one writable copy of the bytes that they are in."""
        if not self._arrays:
            return
        places = places_of(self._run, self.alignment.remainder)
        starts = [places[index] for index, _ in self._arrays]
        _, last = self._arrays[-1]
        end = starts[-1] + NUMBERS[last.type].size * last.size
        source = "data"
        if end - starts[0] > _LARGE_REGION:
            source, self.uses_view = "view", True
        block = self.body.name("block")
        region = f"bytearray({source}[{self._shifted(starts[0])} : {self._shifted(end)}])"
        self.body.assign(block, Positioned(region) if self.offset is None else region)
        for (_, array), start in zip(self._arrays, starts, strict=True):
            numeric, shape = self._constants.runtime("numeric"), f"({array.size},)"
            arguments = f"{shape}, {numeric}.{NUMBERS[array.type].dtype}, {block}, {start - starts[0]}"
            self.body.assign(slot_text(array.slot), f"{numeric}.ndarray({arguments})")

    def _shifted(self, distance: int) -> str:
        if self.offset is not None:
            return str(self.offset + distance)
        return f"p + {distance}" if distance else "p"


def tuple_target(targets: Sequence[str]) -> str:
    """The target of an assignment of a tuple of values."""
    return f"({targets[0]},)" if len(targets) == 1 else f"({', '.join(targets)})"


def _aligned(alignment: int) -> str:
    """The next position of this alignment. Positions in `data` count the header, too, which matters for 8."""
    if alignment == 8:
        return Positioned(f"(p + {7 - HEADER_SIZE} & -8) + {HEADER_SIZE}")
    return Positioned(f"p + {alignment - 1} & -{alignment}")

"""The parts of a serialised message, in order: packed runs, strings, arrays; and the position between them.

The position is known modulo a power of two. Where that is less than some later value needs, the rendered
function keeps `p`: any number that equals the position modulo 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ifgen.generator_py.codec.body import Body, Constants
from ifgen.generator_py.codec.reads import (
    HEADER_SIZE,
    Piece,
    after_run,
    padding_piece,
    run_format,
)
from ifgen.generator_py.codec.statements import POSITION, Positioned
from ifgen.wire.positions import Alignment


class Wire(NamedTuple):
    """The remembered wire form of a string, padded to 4 bytes or as it is."""

    value: str
    is_padded: bool

    @property
    def end(self) -> Alignment:
        """The knowledge about the position after it."""
        return Alignment(4, 0) if self.is_padded else Alignment(1, 0)


class Part(NamedTuple):
    """Something that `bytes.join` takes, or a list of such."""

    value: str
    is_list: bool = False


class Parts:
    """Collects the parts of a message, or of an element in a loop, as Python expressions."""

    def __init__(self, constants: Constants, body: Body, alignment: Alignment, needed: int) -> None:
        self.alignment = alignment
        self.body = body
        self.needed = needed
        self._constants = constants
        self._parts: list[Part] = []
        self._run: list[Piece] = []
        self._texts: list[Wire] = []
        self._before_texts: list[Piece] = []
        self._refusals: list[str] = []

    @property
    def is_tracked(self) -> bool:
        """Whether the position is kept in `p`, since less is known about it than may be needed."""
        return self.alignment.modulus < self.needed

    @property
    def position(self) -> str:
        """The position, or any number that equals it modulo what may be needed."""
        return POSITION if self.is_tracked else str(self.alignment.remainder)

    def refuse(self, *conditions: str) -> None:
        """Check, before what was added since the last flush is used, that none of the conditions holds."""
        self._refusals.extend(conditions)

    def expect(self, piece: Piece) -> None:
        """Add something of fixed layout."""
        self._run.append(piece)

    def add_text(self, text: Wire) -> None:
        """Add a string."""
        if self._texts and self._run:
            self.flush()
        if not self._texts:  # one after another needs nothing: that is padded
            self._pad_run(4, self.alignment)
            self._before_texts, self._run = self._run, []
        self._texts.append(text)

    def add_part(self, value: str, *, is_list: bool = False) -> None:
        """Add what was made before."""
        self._parts.append(Part(value, is_list))

    def add_bytes(self, value: str, end: Alignment) -> None:
        """Add bytes that are made now; `end` is the knowledge about the position after them."""
        part = self.body.name("part")
        self.body.assign(part, value)
        self.add_part(part)
        self.jump(f"len({part})", end)

    def jump(self, distance: str | int, end: Alignment) -> None:
        """Note that this number of bytes was written, and the knowledge about the position after them."""
        if end.modulus < self.needed:
            if self.is_tracked:
                self.body.move(distance)
            else:
                start = self.alignment.remainder
                self.body.place(f"{start} + {distance}" if start else str(distance))
        self.alignment = end

    def align(self, alignment: int) -> None:
        """Flush, padded to the alignment."""
        self._pad_run(alignment, self._texts[-1].end if self._texts else self.alignment)
        self.flush()

    def _pad_run(self, alignment: int, start: Alignment) -> None:
        if not after_run(self._run, start).is_aligned(alignment):
            self._run.append(padding_piece(alignment))

    def flush(self) -> None:
        """Write what is pending: the run, strings in it included, is packed at once."""
        self.body.refuse(self._refusals)
        before, texts, after = self._before_texts, self._texts, self._run
        self._refusals, self._before_texts, self._texts, self._run = [], [], [], []
        if before and texts and after and texts[-1].is_padded and self.alignment.modulus >= 4:
            self._pack_around_texts(before, texts, after)
            return
        self._pack(before)
        for text in texts:
            self.add_bytes(self._wire(text), text.end)
        self._pack(after)

    def emit(self) -> None:
        """Append the parts to the list `out`."""
        match self._parts:
            case []:
                pass
            case [Part(value, is_list=True)]:
                self.body.do(f"out += {value}")
            case [Part(value)]:
                self.body.do(f"out.append({value})")
            case _:
                self.body.do(f"out += ({self._listed()})")
        self._parts = []

    def joined(self) -> str:
        """The parts as one expression."""
        match self._parts:
            case [Part(value, is_list=False)]:
                return value
            case _:
                return f'b"".join(({self._listed()}))'

    def _listed(self) -> str:
        return ", ".join(f"*{part.value}" if part.is_list else part.value for part in self._parts)

    def _wire(self, text: Wire) -> str:
        name = self._constants.runtime("padded_wire" if text.is_padded else "wire")
        return f"{name}[{text.value}]"

    def packed(self, run: Sequence[Piece], start: int) -> str:
        """The expression that packs a run from this position on; a constant if it contains no values."""
        layout = run_format(run, start)[0]
        if all(piece.value is None or piece.is_header for piece in run):
            return self._constants.name(
                f'{self._constants.runtime("packer")}("<{layout}")({_arguments(run)})'
            )
        return f"{self._constants.layout('packer', layout)}({_arguments(run)})"

    def _pack(self, run: list[Piece]) -> None:
        if not run:
            return
        start, end = self.alignment, after_run(run, self.alignment)
        largest = max(piece.alignment for piece in run)
        if largest > start.modulus:
            self._pack_by_position(run, largest, end)
            return
        layout, size = run_format(run, start.remainder)
        if layout:
            self.add_part(self.packed(run, start.remainder))
        if end.modulus < self.needed:
            self.body.move(size)
        self.alignment = end

    def _pack_by_position(self, run: list[Piece], largest: int, end: Alignment) -> None:
        """Choose among the layouts by `p`."""
        call = f"({arguments})" if (arguments := _arguments(run)) else ""
        starts = range(self.alignment.remainder, largest, self.alignment.modulus)
        layouts = {start: f'("<{run_format(run, start)[0]}"){"" if call else "()"}' for start in starts}
        chosen = self._chosen("packer", layouts, largest)
        self.add_bytes(Positioned(chosen + call), end)

    def _pack_around_texts(self, before: list[Piece], texts: list[Wire], after: list[Piece]) -> None:
        """Pack strings together with what is before and after them; the layout depends on their size."""
        text = self.body.name("text")
        value = " + ".join(map(self._wire, texts))
        self.body.assign(text, f"({value})" if len(texts) > 2 else value)
        modulus = min(self.alignment.modulus, self.needed)
        starts = range(self.alignment.remainder % modulus, self.needed, modulus)
        layouts = {start: _around(before, after, start) for start in starts}
        chosen = self._chosen("around_text", layouts, self.needed)
        part = self.body.name("part")
        arguments = ", ".join([*_values(before), text, *_values(after)])
        packed = chosen + f"[len({text})]({arguments})"
        self.body.assign(part, Positioned(packed) if len(layouts) > 1 else packed)
        self.add_part(part)
        # Positions count from after the header. Modulo 8, to add its size is to take it away.
        header = f" + {HEADER_SIZE}" if before[0].is_header else ""
        self.jump(f"len({part}){header}", after_run(after, Alignment(4, 0)))

    def _chosen(self, maker: str, layouts: dict[int, str], modulus: int) -> str:
        """The function that `maker` makes for the layout, chosen by the position if there are several."""
        make = self._constants.runtime(maker)
        if len(layouts) == 1:
            (layout,) = layouts.values()
            return self._constants.name(f"{make}{layout}")
        table = ", ".join(f"{start}: {make}{layout}" for start, layout in layouts.items())
        return self._constants.name(f"{{{table}}}") + f"[p & {modulus - 1}]"


def _around(before: list[Piece], after: list[Piece], start: int) -> str:
    """The layouts of a run from this position on, by the size of the strings in it: a multiple of 4."""
    layout, size = run_format(before, start)
    layouts = {more: run_format(after, (start + size + more) % 8)[0] for more in (0, 4)}
    behind = ", ".join(f'{more}: "{text}"' for more, text in layouts.items())
    return f'("<{layout}", {{{behind}}})'


def _values(run: Sequence[Piece]) -> list[str]:
    return [piece.value for piece in run if piece.value is not None]


def _arguments(run: Sequence[Piece]) -> str:
    return ", ".join(_values(run))

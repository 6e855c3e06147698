"""The parts of a serialised message, in order: packed runs, strings, arrays; and the position between them.

The position is known modulo a power of two. Where that is less than some later value needs, the planned
function keeps `p`: any number that equals the position modulo 8.
"""

from __future__ import annotations

from collections.abc import Sequence

from ifgen.generator_py.codec.alignment import HEADER_SIZE, Alignment, RunItem, after_run, run_format
from ifgen.generator_py.codec.text import Body, Constants

HEADER_VALUE = "256"
HEADER = RunItem("I", 1, 0, HEADER_VALUE)
"""`00 01 00 00`, plain CDR in little endian; positions are counted from its end."""


class Parts:
    """Collects the parts of a message, or of an element in a loop, as Python expressions."""

    def __init__(self, constants: Constants, body: Body, alignment: Alignment, needed: int) -> None:
        self.alignment = alignment
        self.body = body
        self.needed = needed
        self._constants = constants
        self._parts: list[str] = []
        self._run: list[RunItem] = []
        self._texts: list[str] = []
        self._before_texts: list[RunItem] = []
        self._texts_padded = True
        self._refusals: list[str] = []
        self._names = 0

    def name(self, prefix: str) -> str:
        """A new name for a local variable."""
        self._names += 1
        return f"{prefix}{self._names}"

    @property
    def is_tracked(self) -> bool:
        """Whether the position is kept in `p`, since less is known about it than may be needed."""
        return self.alignment.modulus < self.needed

    def refuse(self, *conditions: str) -> None:
        """Check, before what was added since the last flush is used, that none of the conditions holds."""
        self._refusals.extend(conditions)

    def expect(self, item: RunItem) -> None:
        """Add an item of fixed layout."""
        self._run.append(item)

    def add_text(self, value: str, *, padded: bool) -> None:
        """Add a string by its remembered wire form."""
        if self._texts and self._run:
            self.flush()
        if not self._texts:  # one after another needs nothing: that is padded
            if not after_run(self._run, self.alignment).is_aligned(4):
                self._run.append(RunItem("", 4, 0, None))
            self._before_texts, self._run = self._run, []
        wire = self._constants.runtime("padded_wire" if padded else "wire")
        self._texts.append(f"{wire}[{value}]")
        self._texts_padded = padded

    def add_part(self, expression: str) -> None:
        """Add bytes, or something else that can be joined; `*name` for a list of such."""
        self._parts.append(expression)

    def jump(self, distance: str, end: Alignment) -> None:
        """Note that as many bytes were written as the expression says at run time."""
        if end.modulus < self.needed:
            if self.is_tracked:
                self.body.move(distance)
            else:
                start = self.alignment.remainder
                self.body.place(f"{start} + {distance}" if start else distance)
        self.alignment = end

    def align(self, alignment: int) -> None:
        """Flush, padded to the alignment."""
        start = self._after_texts() if self._texts else self.alignment
        if not after_run(self._run, start).is_aligned(alignment):
            self._run.append(RunItem("", alignment, 0, None))
        self.flush()

    def flush(self) -> None:
        """Write what is pending: the run, strings in it included, is packed at once."""
        self.body.refuse(self._refusals)
        self._refusals = []
        before, texts, after = self._before_texts, self._texts, self._run
        self._before_texts, self._texts, self._run = [], [], []
        if before and texts and after and self._texts_padded and self.alignment.modulus >= 4:
            self._pack_around_texts(before, texts, after)
            return
        self._pack(before)
        for text in texts:
            self._write_text(text)
        self._pack(after)

    def emit(self) -> None:
        """Append the parts to the list `out`."""
        if len(self._parts) == 1:
            part = self._parts[0]
            self.body.add(f"out += {part[1:]}" if part.startswith("*") else f"out.append({part})")
        elif self._parts:
            self.body.add(f"out += ({', '.join(self._parts)})")
        self._parts = []

    def joined(self) -> str:
        """The parts as one expression."""
        if len(self._parts) == 1:
            return self._parts[0]
        return f'b"".join(({", ".join(self._parts)}))'

    def packed(self, layout: str, arguments: Sequence[str]) -> str:
        """The expression that packs the arguments; a constant if there are none, or the header alone."""
        return packed(self._constants, layout, arguments)

    def _after_texts(self) -> Alignment:
        return Alignment(4, 0) if self._texts_padded else Alignment(1, 0)

    def _write_text(self, text: str) -> None:
        part = self.name("part")
        self.body.add(f"{part} = {text}")
        self._parts.append(part)
        self.jump(f"len({part})", Alignment(4, 0) if text.startswith("padded") else Alignment(1, 0))

    def _pack(self, run: list[RunItem]) -> None:
        if not run:
            return
        start, end = self.alignment, after_run(run, self.alignment)
        largest = max(item.alignment for item in run)
        if largest > start.modulus:
            self._pack_by_position(run, largest, end)
            return
        layout, size = run_format(run, start.remainder)
        if layout:
            self._parts.append(self.packed(layout, _arguments(run)))
        if end.modulus < self.needed:
            self.body.move(str(size))
        self.alignment = end

    def _pack_by_position(self, run: list[RunItem], largest: int, end: Alignment) -> None:
        """Choose among the layouts by `p`."""
        arguments = _arguments(run)
        suffix = "" if arguments else "()"
        starts = range(self.alignment.remainder, largest, self.alignment.modulus)
        packer = self._constants.runtime("packer")
        table = ", ".join(f'{start}: {packer}("<{run_format(run, start)[0]}"){suffix}' for start in starts)
        chosen = f"{self._constants.name(f'{{{table}}}')}[p & {largest - 1}]"
        self._write_packed(f"{chosen}({', '.join(arguments)})" if arguments else chosen, end)

    def _pack_around_texts(self, before: list[RunItem], texts: list[str], after: list[RunItem]) -> None:
        """Pack strings together with the items before and after them; the layout depends on their size."""
        text = self.name("text")
        joined = " + ".join(texts)
        self.body.add(f"{text} = ({joined})" if len(texts) > 2 else f"{text} = {joined}")
        modulus = min(self.alignment.modulus, self.needed)
        tables = {
            start: self._around(before, after, start)
            for start in range(self.alignment.remainder % modulus, self.needed, modulus)
        }
        if len(tables) == 1:
            (table,) = tables.values()
            chosen = self._constants.name(table)
        else:
            entries = ", ".join(f"{start}: {table}" for start, table in tables.items())
            chosen = f"{self._constants.name(f'{{{entries}}}')}[p & {self.needed - 1}]"
        arguments = [*_arguments(before), text, *_arguments(after)]
        end = after_run(after, Alignment(4, 0))
        self._write_packed(
            f"{chosen}[len({text})]({', '.join(arguments)})", end, uncounted=before[0] is HEADER
        )

    def _around(self, before: list[RunItem], after: list[RunItem], start: int) -> str:
        """The layouts of a run from this position on, by the size of the strings in it: a multiple of 4."""
        layout, size = run_format(before, start)
        layouts = {more: run_format(after, (start + size + more) % 8)[0] for more in (0, 4)}
        behind = ", ".join(f'{more}: "{text}"' for more, text in layouts.items())
        return f'{self._constants.runtime("around_text")}("<{layout}", {{{behind}}})'

    def _write_packed(self, expression: str, end: Alignment, *, uncounted: bool = False) -> None:
        part = self.name("part")
        self.body.add(f"{part} = {expression}")
        self._parts.append(part)
        # Positions count from the end of the header. Modulo 8, adding its size is subtracting it.
        self.jump(f"len({part}) + {HEADER_SIZE}" if uncounted else f"len({part})", end)


def packed(constants: Constants, layout: str, arguments: Sequence[str]) -> str:
    """The expression that packs the arguments; a constant if there are none, or the header alone."""
    if arguments and arguments != [HEADER_VALUE]:
        return f"{constants.layout('packer', layout)}({', '.join(arguments)})"
    return constants.name(f'{constants.runtime("packer")}("<{layout}")({", ".join(arguments)})')


def _arguments(run: list[RunItem]) -> list[str]:
    return [item.expression for item in run if item.expression is not None]

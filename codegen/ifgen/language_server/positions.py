"""Places in a text as an editor counts them: by line, and within it in units that the client chose."""

from __future__ import annotations

import re
from bisect import bisect_right
from typing import Final

from lsprotocol.types import Position, PositionEncodingKind, Range

_BREAK: Final = re.compile(r"\n|\r")


class Positions:
    """From offsets in a text to positions of the protocol, and back. Offsets count code points.

    The text has plain line ends, as those have that our diagnostics speak of.
    """

    def __init__(self, text: str, encoding: str) -> None:
        self.text = text
        self._encoding = encoding
        ends = [match.span() for match in _BREAK.finditer(text)]
        self._starts = [0, *(end for _, end in ends)]
        self._stops = [*(start for start, _ in ends), len(text)]

    def position(self, offset: int) -> Position:
        """The position of an offset; that of the text's end for any beyond."""
        line = max(bisect_right(self._starts, offset) - 1, 0)
        return self._position(line, offset - self._starts[line])

    def range(self, start: int, end: int) -> Range:
        """The range between two offsets."""
        return Range(self.position(start), self.position(end))

    def offset(self, position: Position) -> int:
        """The offset of a position; the end of the line for a position beyond it."""
        if position.line >= len(self._starts):
            return len(self.text)
        start, stop = self._starts[position.line], self._stops[position.line]
        line = self.text[start:stop]
        return start + min(self._code_points(line, position.character), len(line))

    def line(self, number: int) -> str:
        """The text of a line, counted from 0, without its break."""
        return self.text[self._starts[number] : self._stops[number]]

    def start(self, number: int) -> int:
        """The offset at which a line starts."""
        return self._starts[number]

    @property
    def lines(self) -> int:
        """The number of lines; one that is empty follows the last line break."""
        return len(self._starts)

    def whole(self) -> Range:
        """The range of the whole text."""
        return self.range(0, len(self.text))

    def _position(self, line: int, column: int) -> Position:
        before = self.text[self._starts[line] : self._stops[line]][: max(column, 0)]
        return Position(line, self._units(before))

    def _units(self, text: str) -> int:
        match self._encoding:
            case PositionEncodingKind.Utf32:
                return len(text)
            case PositionEncodingKind.Utf8:
                return len(text.encode("utf-8", "surrogatepass"))
            case _:
                return len(text) + sum(character > "\uffff" for character in text)

    def _code_points(self, line: str, units: int) -> int:
        if line.isascii():
            return units
        taken = 0
        for number, character in enumerate(line):
            if taken >= units:
                return number
            taken += self._units(character)
        return len(line)

"""Runs of values as `struct` lays them out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Final, NamedTuple

from ifgen.definition.types import BasicTypeName
from ifgen.wire.positions import COUNT_SIZE, Alignment
from ifgen.wire.program import NUMBERS

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

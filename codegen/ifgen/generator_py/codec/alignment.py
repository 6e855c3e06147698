"""Knowledge about a position, and runs of values whose layout depends on nothing else."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import gcd

HEADER_SIZE = 4
"""Bytes before the position from which everything is aligned."""

_REPEATED = re.compile(r"(?<!\d)([a-zA-Z?])\1+")


@dataclass(frozen=True, slots=True)
class Alignment:
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

    def either(self, other: Alignment) -> Alignment:
        """The knowledge that holds for both positions."""
        modulus = gcd(self.modulus, other.modulus, self.remainder - other.remainder)
        return Alignment(modulus, self.remainder % modulus)

    def is_aligned(self, alignment: int) -> bool:
        """Whether no padding can be needed before a value of this alignment."""
        return self.modulus >= alignment and self.remainder % alignment == 0


@dataclass(frozen=True, slots=True)
class RunItem:
    """One item of a run of fixed layout: its `struct` format, alignment and size.

    `expression` is what to pack or where to unpack to; None for bytes that are only skipped.
    """

    format: str
    alignment: int
    size: int
    expression: str | None


def after_run(run: list[RunItem], start: Alignment) -> Alignment:
    """The knowledge about the position after a run."""
    for item in run:
        start = start.aligned(item.alignment).advanced(item.size)
    return start


def item_places(items: list[RunItem], start: int) -> list[int]:
    """The offsets of the items of a run from its start, which is this position modulo 8."""
    places: list[int] = []
    position = start
    for item in items:
        position += -position % item.alignment
        places.append(position - start)
        position += item.size
    return places


def run_format(items: list[RunItem], start: int) -> tuple[str, int]:
    """The `struct` format and the size, padding included, of a run that starts at this position modulo 8."""
    text, position = "", start
    for item in items:
        padding = -position % item.alignment
        text += ("x" * padding if padding < 3 else f"{padding}x") + item.format
        position += padding + item.size
    return _shortened(text), position - start


def _shortened(text: str) -> str:
    """Fold repeated characters: `dddI` is `3dI`; the counts of `72s72s` are lengths and stay."""
    return _REPEATED.sub(lambda match: f"{len(match[0])}{match[1]}", text)

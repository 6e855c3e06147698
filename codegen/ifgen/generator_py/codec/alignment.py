"""Knowledge about a position before a program runs."""

from __future__ import annotations

from collections.abc import Iterable
from math import gcd
from typing import NamedTuple


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

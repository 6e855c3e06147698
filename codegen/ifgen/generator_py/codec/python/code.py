"""Python text of the codec: expressions, some of which contain the position `p`."""

from __future__ import annotations

from typing import NoReturn

from ifgen.generator_py.codec.program import Slot


class Positioned(str):
    """An expression with the position `p` in it. An f-string would forget that, and refuses it."""

    __slots__ = ()

    def __format__(self, specification: str) -> NoReturn:
        raise TypeError(f"{str(self)!r} contains the position, which an f-string would forget")


POSITION = Positioned("p")
"""The variable for a position that is not known as a number."""


def variable(message: int) -> str:
    """The name of the variable for the message with this number."""
    return f"v{message}" if message else "m"


def slot_text(slot: Slot) -> str:
    """The value in a slot."""
    return f"{variable(slot.message)}.{slot.name}"


def product(count: str | int, size: int) -> str | int:
    """The count times the size, computed if the count is known."""
    if isinstance(count, int):
        return count * size
    return count if size == 1 else f"{count} * {size}"

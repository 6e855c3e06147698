"""Words: the arguments of commands."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from ifgen.reading.cmake.values import Doubt, worse


class Word(NamedTuple):
    """A word; one in quotes is never an operator of a condition or the name of a variable in it."""

    text: str
    quoted: bool
    doubt: Doubt | None = None


def texts(words: Iterable[Word]) -> list[str]:
    """The texts of the words, without those that stand for an unknown list."""
    return [word.text for word in words if word.text or word.quoted]


def doubt_of(words: Iterable[Word]) -> Doubt | None:
    """The doubt that counts of all of them."""
    return worse(*(word.doubt for word in words))

"""Two texts beside each other, or one below the other where a terminal is too narrow for that."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from itertools import zip_longest
from typing import Final, NamedTuple

_NARROW: Final = 60
"""Columns of a terminal that has no room for two texts."""

_HANGING: Final = "  "
_UNPRINTABLE: Final = dict.fromkeys((*range(0x20), *range(0x7F, 0xA0)), "\N{REPLACEMENT CHARACTER}")
"""Characters that could steer a terminal: names of files and texts in constants may hold any."""

_STYLES: Final = {"|": "yellow", "<": "red", ">": "green", "-": "red", "+": "green", " ": ""}


class Row(NamedTuple):
    """A line for a terminal, with its style."""

    text: str
    style: str


class _Pair(NamedTuple):
    """A line of each text, and a sign: a blank for equal ones, `|`, `<` and `>` as diff(1) has them."""

    sign: str
    left: str
    right: str


def rows(left: Sequence[str], right: Sequence[str], width: int, head: int = 0) -> Iterator[Row]:
    """The lines of both texts, at most `width` cells wide. The first `head` lines belong together."""
    left, right = ([line.translate(_UNPRINTABLE) for line in lines] for lines in (left, right))
    pairs = [
        _Pair(" " if one == other else "|", one, other)
        for one, other in zip(left[:head], right[:head], strict=False)
    ]
    pairs += _pairs(left[len(pairs) :], right[len(pairs) :])
    yield from _below(pairs) if width < _NARROW else _beside(pairs, width)


def _pairs(left: Sequence[str], right: Sequence[str]) -> Iterator[_Pair]:
    for tag, start, end, start_right, end_right in SequenceMatcher(
        None, left, right, autojunk=False
    ).get_opcodes():
        before, after = left[start:end], right[start_right:end_right]
        if tag == "replace":
            yield from _alike(before, after)
            continue
        for one, other in zip_longest(before, after):
            sign = ">" if one is None else "<" if other is None else " "
            yield _Pair(sign, one or "", other or "")


def _alike(before: Sequence[str], after: Sequence[str]) -> Iterator[_Pair]:
    """The lines of a block that differs: each beside one that shares a word with it, if there is any."""
    at = 0
    for line in before:
        words = set(line.split())
        found = next((n for n in range(at, len(after)) if words & set(after[n].split())), None)
        if found is None:
            yield _Pair("<", line, "")
            continue
        yield from (_Pair(">", "", other) for other in after[at:found])
        yield _Pair("|", line, after[found])
        at = found + 1
    yield from (_Pair(">", "", other) for other in after[at:])


def _beside(pairs: Sequence[_Pair], width: int) -> Iterator[Row]:
    column = (width - 3) // 2
    for sign, left, right in pairs:
        parts = zip_longest(_wrapped(left, column), _wrapped(right, column), fillvalue="")
        for number, (one, other) in enumerate(parts):
            padding = " " * (column - _width(one))
            yield Row(f"{one}{padding} {sign if not number else ' '} {other}".rstrip(), _STYLES[sign])


def _below(pairs: Sequence[_Pair]) -> Iterator[Row]:
    """All lines below each other, for which the terminal has its own way to wrap them."""
    for sign, left, right in pairs:
        if sign == " ":
            yield Row(f"  {left}".rstrip(), "")
            continue
        if sign in "<|":
            yield Row(f"- {left}", _STYLES["-"])
        if sign in ">|":
            yield Row(f"+ {right}", _STYLES["+"])


def _wrapped(text: str, width: int) -> list[str]:
    """The lines of a text in a column; a break comes after a blank if there is one in sight."""
    lines: list[str] = []
    indent = " " * (len(text) - len(text.lstrip())) + _HANGING
    while _width(text) > width:
        end = _fitting(text, width)
        blank = text.rfind(" ", len(indent) + 1, end + 1)
        end = blank if blank > 0 else end
        lines.append(text[:end].rstrip())
        text = indent[: width // 2] + text[end:].lstrip()
    return [*lines, text]


def _fitting(text: str, width: int) -> int:
    """The number of characters that fit."""
    end = 0
    while end < len(text) and _width(text[: end + 1]) <= width:
        end += 1
    return max(end, 1)


def _width(text: str) -> int:
    """The number of cells of a text."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text
    )

"""The values of the variables of a `foreach()` in each iteration."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ifgen.reading.cmake.keywords import parsed
from ifgen.reading.cmake.state import State
from ifgen.reading.cmake.values import EMPTY, Doubt, Value, elements, worse
from ifgen.reading.cmake.words import Word, doubt_of, texts

Turns = tuple[list[str], Sequence[Sequence[str]], Doubt | None]
"""The names of the variables, what they are in each turn, and what is not sure about that."""


def turns(state: State, words: Sequence[Word]) -> Turns:
    """The turns of `foreach(WORDS)`."""
    said = texts(words)
    doubt = doubt_of(words)
    if "IN" in said[1:]:
        at = said.index("IN", 1)
        given = parsed(said[at + 1 :], (), (), ("LISTS", "ITEMS", "ZIP_LISTS"))
        return _in(state, said[:at], given, doubt)
    if said[1:2] == ["RANGE"]:
        return said[:1], _range(state, said[2:]), doubt
    return said[:1], [(item,) for item in said[1:]], doubt


def _in(state: State, names: list[str], given: dict[str, list[str]], doubt: Doubt | None) -> Turns:
    """The turns of `foreach(NAMES IN ...)`."""
    zipped = "ZIP_LISTS" in given
    values = [_value(state, name) for name in given.get("ZIP_LISTS" if zipped else "LISTS", ())]
    doubt = worse(doubt, *(value.doubt for value in values))
    columns = [elements(value.text, keep_empty=True) for value in values]
    state.spend(sum(len(value.text) for value in values))
    if not zipped:
        items = [item for column in (*columns, given.get("ITEMS", [])) for item in column]
        return names, [(item,) for item in items], doubt
    if len(names) == 1:
        names = [f"{names[0]}_{number}" for number in range(len(columns))]
    length = max(map(len, columns), default=0)
    filled = [column + [""] * (length - len(column)) for column in columns]
    return names, list(zip(*filled, strict=True)), doubt


def _range(state: State, said: Sequence[str]) -> list[tuple[str]]:
    if len(said) not in {1, 2, 3} or not all(re.fullmatch(r"-?[0-9]{1,9}", text) for text in said):
        return []
    first, last, step = (0, int(said[0]), 1) if len(said) == 1 else (int(said[0]), int(said[1]), 1)
    step = int(said[2]) if len(said) == 3 else step
    if step < 1:
        return []
    numbers = range(first, last + 1, step)
    state.spend(20 * len(numbers))
    return [(str(number),) for number in numbers]


def _value(state: State, name: str) -> Value:
    return state.variables.get(name) or EMPTY

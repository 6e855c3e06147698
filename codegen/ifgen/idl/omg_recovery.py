"""The text of an .idl file without the part whose syntax is wrong, so that the rest can be read.

All other characters stay at their places.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Set
from typing import Final

_TOKEN: Final = re.compile(
    r"""//[^\n]*|/\*[\s\S]*?(?:\*/|\Z)|"(?:[^"\\\n]|\\[^\n])*"?|'(?:[^'\\\n]|\\[^\n])*'?|(?P<sign>[;{}])"""
)


def without(text: str, position: int, expected: Set[str]) -> str | None:
    """The text that goes on behind an error at a position; None if there is nothing to leave out.

    A semicolon that is missing at the end of a line is put there. Otherwise the member or definition around
    the position goes, with all that it holds in braces.
    """
    space = len(text[:position].rstrip())
    if "_SEMICOLON" in expected and "\n" in text[space:position]:
        return f"{text[:space]};{text[space + 1 :]}"
    signs = [(match.start(), match["sign"]) for match in _TOKEN.finditer(text) if match["sign"]]
    index = bisect_left(signs, (position, ""))
    start = signs[index - 1][0] + 1 if index else 0
    end = _end(signs, index, len(text))
    if not text[start:end].strip():
        end = start + 1 if start < len(text) else start  # a brace too many
    blank = re.sub(r"[^\n]", " ", text[start:end])
    return f"{text[:start]}{blank}{text[end:]}" if blank.strip("\n") and text[start:end] != blank else None


def _end(signs: list[tuple[int, str]], index: int, length: int) -> int:
    """The end of the definition that goes on at a sign: its semicolon, or the brace that closes around it."""
    depth = 0
    for place, sign in signs[index:]:
        if sign == ";" and depth == 0:
            return place + 1
        if sign == "{":
            depth += 1
        elif sign == "}":
            if depth == 0:
                return place
            depth -= 1
    return length

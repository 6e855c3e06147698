"""CMake's patterns: of file names, and regular expressions as far as they cannot take for ever."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from typing import Final

_MAX_LENGTH: Final = 200
_MAX_REPEATS: Final = 3
_MAX_BRANCHES: Final = 6
_GLOB_PART: Final = re.compile(r"\*+|\?|\[[!^]?\]?[^\]]*\]|.", re.DOTALL)


class Unsure(Exception):
    """The matches of a pattern are unknown, or cannot be found in a reasonable time."""


@lru_cache(maxsize=64)
def glob(pattern: str) -> re.Pattern[str]:
    """A pattern of one part of a path, such as `*.msg`. Raises Unsure for one with too many stars."""
    parts: list[str] = []
    stars = 0
    for match in _GLOB_PART.finditer(pattern):
        token = match[0]
        if token.startswith("*"):
            stars += 1
            parts.append(".*")
        elif token == "?":
            parts.append(".")
        elif token.startswith("[") and len(token) > 2:
            parts.append(_one_of(token[1:-1].replace("!", "^", 1) if token[1] == "!" else token[1:-1]))
        else:
            parts.append(re.escape(token))
    if stars > _MAX_REPEATS:
        raise Unsure
    return _compiled("".join(parts))


def regex(pattern: str, subjects: Sequence[str]) -> tuple[re.Pattern[str], int]:
    """A regular expression to search texts with, and how many steps Python, which backtracks, needs at most.

    Raises Unsure for one that is wrong, and for one that could need time beyond measure.
    """
    compiled, repeats, branches = _regex(pattern)
    longest = max(map(len, subjects), default=0)
    return compiled, len(subjects) * (longest + 1) ** (repeats + 1) * 2**branches


@lru_cache(maxsize=64)
def _regex(pattern: str) -> tuple[re.Pattern[str], int, int]:
    """In Python's words; how many parts of it are repeated without a bound, and how many are a choice."""
    if len(pattern) > _MAX_LENGTH:
        raise Unsure
    parts: list[str] = []
    repeats = branches = at = 0
    while at < len(pattern):
        character = pattern[at]
        if character == "[":
            end = pattern.find("]", at + (3 if pattern.startswith("[^", at) else 2))
            if end < 0:
                raise Unsure
            parts.append(_one_of(pattern[at + 1 : end]))
            at = end
        elif character == "\\":
            at += 1
            parts.append(re.escape(pattern[at : at + 1]))
        elif character in "*+?":
            # A repeated group may take time that doubles with each letter.
            if not parts or parts[-1] in {"(", "|", "*", "+", "?"} or (parts[-1] == ")" and character != "?"):
                raise Unsure
            repeats += character != "?"
            branches += character == "?"
            parts.append(character)
        elif character == "$":
            parts.append(r"\Z")
        elif character in ".^()|":
            branches += character == "|"
            parts.append(character)
        else:
            parts.append(re.escape(character))
        at += 1
    if repeats > _MAX_REPEATS or branches > _MAX_BRANCHES:
        raise Unsure
    return _compiled("".join(parts)), repeats, branches


def _one_of(inside: str) -> str:
    """`[...]`, in which CMake has no escapes."""
    negated = inside.startswith("^")
    if "--" in inside:
        raise Unsure  # Python may give that a meaning in the future
    # Python gives a meaning to a backslash, to brackets, and to some doubled letters.
    text = re.sub(r"[\\\[\]&~|]", r"\\\g<0>", inside[negated:])
    return f"[{'^' if negated else ''}{text}]"


def _compiled(pattern: str) -> re.Pattern[str]:
    try:
        return re.compile(pattern, re.DOTALL)
    except (re.error, RecursionError, OverflowError):
        raise Unsure from None

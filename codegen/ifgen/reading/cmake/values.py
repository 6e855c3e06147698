"""Texts of CMake, with a doubt if only a build knows all of one: their references, lists and patterns."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

from ifgen.diagnostics import Span

_ESCAPES: Final = {"n": "\n", "r": "\r", "t": "\t", ";": "\\;"}
_REFERENCE_PART: Final = re.compile(r"\\(.)|\$(ENV|CACHE)?\{|\}|\\$", re.DOTALL)
_MAX_NESTING: Final = 20
_MAX_LENGTH: Final = 200
_MAX_REPEATS: Final = 3
_MAX_BRANCHES: Final = 6
_GLOB_PART: Final = re.compile(r"\*+|\?|\[[!^]?\]?[^\]]*\]|.", re.DOTALL)
_PART: Final = re.compile(r"\[\^?\]?[^\]]*\]|\\?.", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Doubt:
    """The reason why a value is uncertain; `reason` continues "because ...".

    `lost` if nothing of the value is known, so that a list may be longer; else something was assumed.
    """

    reason: str
    span: Span
    lost: bool = False


class Value(NamedTuple):
    """A text, in which `;` separates the elements of a list, and what is not sure about it.

    As an argument that is in quotes it is never an operator of a condition or the name of a variable in it.
    """

    text: str
    doubt: Doubt | None = None
    quoted: bool = False


EMPTY: Final = Value("")


class Unsure(Exception):
    """The effect of a command is unknown, or cannot be found in a reasonable time."""


class Unclosed(Exception):
    """A `${` has no `}`, or too many are within one another."""


def worse(*doubts: Doubt | None) -> Doubt | None:
    """The doubt that counts of several: that something is lost, else the first."""
    some = [doubt for doubt in doubts if doubt is not None]
    return next((doubt for doubt in some if doubt.lost), some[0] if some else None)


def worst_in(values: Iterable[Value]) -> Doubt | None:
    """The doubt that counts of all of them."""
    return worse(*(value.doubt for value in values))


def texts(words: Iterable[Value]) -> list[str]:
    """The texts of arguments, without those that stand for an unknown list."""
    return [word.text for word in words if word.text or word.quoted]


def expanded(text: str, variable: Callable[[str, str], Value]) -> Value:
    """A text with its escapes and `${references}` evaluated; `variable` has the value of `(where, name)`.

    `where` is empty, `ENV` or `CACHE`. Raises Unclosed.
    """
    if "$" not in text and "\\" not in text:
        return Value(text)
    stack: list[tuple[str, list[str]]] = [("", [])]
    doubt: Doubt | None = None
    at = 0
    for match in _REFERENCE_PART.finditer(text):
        stack[-1][1].append(text[at : match.start()])
        at = match.end()
        token = match[0]
        if token.startswith("\\"):
            stack[-1][1].append(_ESCAPES.get(match[1] or "", match[1] or "\\"))
        elif token != "}":
            stack.append((match[2] or "", []))
            if len(stack) > _MAX_NESTING:
                raise Unclosed
        elif len(stack) == 1:
            stack[-1][1].append("}")
        else:
            where, name = stack.pop()
            value = variable(where, "".join(name))
            doubt = worse(doubt, value.doubt)
            stack[-1][1].append(value.text)
    if len(stack) > 1:
        raise Unclosed
    stack[0][1].append(text[at:])
    return Value("".join(stack[0][1]), doubt)


def elements(text: str, keep_empty: bool = False) -> list[str]:
    """The elements of a list; a `;` within square brackets or after a backslash separates nothing."""
    if ";" not in text:
        return [text] if text else []
    found = [""]
    nesting = 0
    for token in re.findall(r"\\;|[\[\];]|[^\\\[\];]+|\\", text):
        nesting += (token == "[") - (token == "]")
        if token == ";" and not nesting:
            found.append("")
        else:
            found[-1] += ";" if token == "\\;" and not nesting else token
    return found if keep_empty else [element for element in found if element]


def by_keyword(
    words: Iterable[str], options: Collection[str], single: Collection[str], several: Collection[str]
) -> dict[str, list[str]]:
    """The words after each keyword, as `cmake_parse_arguments` has them; the rest is under the empty keyword.

    An option that is there has an empty list.
    """
    found: dict[str, list[str]] = {"": []}
    current = ""
    for word in words:
        if word in options:
            found[word] = []
            current = ""
        elif word in single or word in several:
            found.setdefault(word, [])
            current = word
        else:
            found[current].append(word)
            if current in single:
                current = ""
    return found


@lru_cache(maxsize=64)
def glob(pattern: str) -> re.Pattern[str]:
    """A pattern of one part of a path, such as `*.msg`. Raises Unsure for one with too many stars."""
    parts: list[str] = []
    for token in _GLOB_PART.findall(pattern):
        if token.startswith("*"):
            parts.append(".*")
        elif token == "?":
            parts.append(".")
        elif token.startswith("[") and len(token) > 2:
            parts.append(_one_of("^" + token[2:-1] if token[1] == "!" else token[1:-1]))
        else:
            parts.append(re.escape(token))
    if parts.count(".*") > _MAX_REPEATS:
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
    parts: list[str] = []
    for token in _PART.findall(pattern[: _MAX_LENGTH + 1]):
        if len(token) > 1 and token.startswith("["):
            parts.append(_one_of(token[1:-1]))
        elif token in {"*", "+", "?"}:
            # A repeated group may take time that doubles with each letter.
            if not parts or parts[-1] in {"(", "|", "*", "+", "?"} or (parts[-1] == ")" and token != "?"):
                raise Unsure
            parts.append(token)
        elif token == "[":
            raise Unsure
        elif token == "$":
            parts.append(r"\Z")
        else:
            parts.append(token if token in ".^()|" else re.escape(token[-1]))
    repeats, branches = parts.count("*") + parts.count("+"), parts.count("?") + parts.count("|")
    if len(pattern) > _MAX_LENGTH or repeats > _MAX_REPEATS or branches > _MAX_BRANCHES:
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

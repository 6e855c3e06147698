"""Values of CMake variables: a text, and a doubt if only CMake knows all of it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final, NamedTuple

from ifgen.diagnostics import Span


@dataclass(frozen=True, slots=True)
class Doubt:
    """The reason why a value is uncertain; `reason` continues "because ...".

    `lost` if nothing of the value is known, so that a list may be longer; else something was assumed.
    """

    reason: str
    span: Span
    lost: bool = False


class Value(NamedTuple):
    """A text, in which `;` separates the elements of a list, and what is not sure about it."""

    text: str
    doubt: Doubt | None = None


EMPTY: Final = Value("")

_ESCAPES: Final = {"n": "\n", "r": "\r", "t": "\t", ";": "\\;"}
_REFERENCE_PART: Final = re.compile(r"\\(.)|\$(ENV|CACHE)?\{|\}|\\$", re.DOTALL)
_MAX_NESTING: Final = 20


class Unclosed(Exception):
    """A `${` has no `}`, or too many are within one another."""


def worse(*doubts: Doubt | None) -> Doubt | None:
    """The doubt that counts of several: that something is lost, else the first."""
    first = None
    for doubt in doubts:
        if doubt is not None and doubt.lost:
            return doubt
        first = first or doubt
    return first


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
    found: list[str] = []
    nesting = start = 0
    current: list[str] = []
    for match in re.finditer(r"\\;|[\[\];]", text):
        token = match[0]
        if token == "[":
            nesting += 1
        elif token == "]":
            nesting -= 1
        elif not nesting:
            current.append(text[start : match.start()])
            start = match.end()
            if token == ";":
                found.append("".join(current))
                current = []
            else:
                current.append(";")
    found.append("".join([*current, text[start:]]))
    return found if keep_empty else [element for element in found if element]


def joined(parts: Iterable[str]) -> str:
    """A list of these elements."""
    return ";".join(parts)

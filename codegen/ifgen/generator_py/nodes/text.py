"""Python text as `ruff format` leaves it: literals, calls and signatures."""

from __future__ import annotations

import math
from collections.abc import Iterable

from ifgen.generator_py.imports import LINE_LENGTH
from ifgen.nodl.model import ParameterValue

_LONG = 36


def literal(value: ParameterValue) -> str:
    """A Python literal; the list of an array's elements, single bytes for a byte_array."""
    match value:
        case str():
            return quoted(value)
        case float() if not math.isfinite(value):
            return f'float("{value}")'
        case bytes():
            return f"[{', '.join(_double_quoted(repr(bytes([byte]))) for byte in value)}]"
        case tuple():
            return f"[{', '.join(map(literal, value))}]"
        case _:
            return repr(value)


def quoted(text: str) -> str:
    """A string literal, in double quotes unless single ones need fewer backslashes."""
    return _double_quoted(repr(text))


def _double_quoted(literal: str) -> str:
    start = literal.index("'") if literal.endswith("'") else -1
    if start < 0:
        return literal
    prefix, body = literal[:start], literal[start + 1 : -1]
    if '"' in body and body.count('"') > body.count("\\'"):
        return literal
    body = body.replace('"', '\\"').replace("\\'", "'")
    return f'{prefix}"{body}"'


def call(function: str, arguments: Iterable[str], indent: int) -> str:
    """A call whose arguments have a line each; the first line is not indented."""
    margin = " " * indent
    return f"{function}(\n" + "".join(f"{margin}    {argument},\n" for argument in arguments) + f"{margin})"


def signature(name: str, parameters: Iterable[str], result: str, *, is_async: bool = False) -> str:
    """The first line of a method, or its first lines where that would be too long; `self` is understood."""
    start = f"{'async ' if is_async else ''}def {name}"
    everything = ["self", *parameters]
    line = f"{start}({', '.join(everything)}) -> {result}:"
    if len(line) + 4 <= LINE_LENGTH:
        return line
    return f"{call(start, everything, indent=4)} -> {result}:"


def are_long(names: Iterable[str]) -> bool:
    """Whether lines with two of these names may be too long; `ruff format` would break them in other ways."""
    return any(len(name) > _LONG for name in names)

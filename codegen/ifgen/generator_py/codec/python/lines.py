"""Statements as lines of Python, broken where they are too long."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final, assert_never

from ifgen.generator_py.codec.python.statements import (
    Assign,
    Choice,
    Do,
    For,
    If,
    Move,
    Place,
    Refuse,
    Return,
    Statement,
)

LINE_LENGTH: Final = 104  # the text stands in an `if not TYPE_CHECKING`
_BEGIN_LINES: Final = ("or", "and", "for", "if", "+")


def lines_of(statements: Iterable[Statement], indent: int) -> list[str]:
    """The lines of the statements."""
    lines: list[str] = []
    for statement in statements:
        match statement:
            case Do(value):
                lines += wrapped(value, indent)
            case Assign(target, value):
                lines += wrapped(target + " = " + value, indent)
            case Place(position):
                lines += wrapped("p = " + position, indent)
            case Move(distance):
                lines += wrapped(f"p += {distance}", indent)
            case Return(value):
                lines += wrapped("return " + value, indent)
            case Refuse(condition):
                lines += _condition(condition, indent)
                lines.append("    " * (indent + 1) + "raise TypeError")
            case If(condition, body):
                lines += _condition(condition, indent)
                lines += lines_of(body, indent + 1)
            case Choice(condition, body, otherwise):
                lines += _condition(condition, indent)
                lines += lines_of(body, indent + 1)
                lines.append("    " * indent + "else:")
                lines += lines_of(otherwise, indent + 1)
            case For(variable, values, body):
                lines += wrapped(f"for {variable} in " + values + ":", indent)
                lines += lines_of(body, indent + 1)
            case _:
                assert_never(statement)
    return lines


def _condition(text: str, indent: int) -> list[str]:
    line = "if " + text + ":"
    return wrapped(line if _fits(line, indent) else "if (" + text + "):", indent)


def _fits(text: str, indent: int) -> bool:
    return 4 * indent + len(text) <= LINE_LENGTH


def wrapped(text: str, indent: int) -> list[str]:
    """The statement on one line, or broken inside brackets where it is too long."""
    margin = "    " * indent
    if _fits(text, indent):
        return [margin + text]
    lines: list[str] = []
    line, counted, depth = margin, 0, 0
    for part in _parts(text, LINE_LENGTH - len(margin) - 4):
        if len(line) + len(part) > LINE_LENGTH:
            depth += _opened(line[counted:])
            counted = len(line)
            if depth:
                lines.append(line.rstrip())
                line, counted = margin + "    ", 0
        line += part + " "
    return [*lines, line.rstrip()]


def _opened(text: str) -> int:
    """The number of brackets that are open after a text."""
    opened = text.count("(") + text.count("[") + text.count("{")
    return opened - text.count(")") - text.count("]") - text.count("}")


def _parts(text: str, room: int) -> Iterator[str]:
    """The pieces that stay on one line: up to a comma or an operator, or each word if there is no room."""
    text = text.replace(", ", ",\n")
    for word in _BEGIN_LINES:
        text = text.replace(f" {word} ", f"\n{word} ")
    for part in text.split("\n"):
        yield from [part] if len(part) <= room else part.split(" ")

"""The statements of codecs: which of them matter, and their lines, broken where they are too long.

They are named tuples, which are made in half the time of frozen dataclasses: a large message has 100,000 of
them. An expression in them knows if it contains the position `p`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple, NoReturn, TypeAlias, assert_never

from ifgen.wire.program import Slot


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


class Do(NamedTuple):
    """A statement that is an expression, or changes a variable other than the position."""

    value: str


class Assign(NamedTuple):
    """`target = value`."""

    target: str
    value: str


class Place(NamedTuple):
    """`p = position`, and nothing else."""

    position: str


class Move(NamedTuple):
    """`p += distance`."""

    distance: str


class Return(NamedTuple):
    """`return value`."""

    value: str


class Refuse(NamedTuple):
    """Leave the fast path if the condition holds."""

    condition: str


class If(NamedTuple):
    """The body runs if the condition holds."""

    condition: str
    body: tuple[Statement, ...]


class Choice(NamedTuple):
    """One of two bodies runs. Both read the position, and move it within expressions only."""

    condition: str
    body: tuple[Assign | Do, ...]
    otherwise: tuple[Assign | Do, ...]


class For(NamedTuple):
    """The body runs for each of the values."""

    variable: str
    values: str
    body: tuple[Statement, ...]


Statement: TypeAlias = Do | Assign | Place | Move | Return | Refuse | If | Choice | For


def without_idle_moves(statements: Sequence[Statement], read_later: bool = False) -> tuple[Statement, ...]:
    """The statements without updates of a position that neither they nor later statements read."""
    kept: list[Statement] = []
    live = read_later
    for statement in reversed(statements):
        match statement:
            case If(body=body) | For(body=body):
                entered = reads_first(body)  # as it may be again, in a loop
                if body := without_idle_moves(body, live or entered):
                    kept.append(statement._replace(body=body))
                live = live or reads_first([statement])
            case Place(position):
                if live:
                    kept.append(statement)
                    live = isinstance(position, Positioned)
            case Move():
                if live:
                    kept.append(statement)
            case _:
                kept.append(statement)
                live = live or reads_first([statement])
    return tuple(kept[::-1])


def reads_first(statements: Sequence[Statement]) -> bool:
    """Whether the statements read the position that they find, apart from moving it."""
    for statement in statements:
        match statement:
            case Place(position):
                if not isinstance(position, Positioned):
                    return False
            case Move():
                pass
            case Choice():
                return True
            case Do(value) | Return(value) | Refuse(value):
                if isinstance(value, Positioned):
                    return True
            case Assign(target, value):
                if isinstance(target, Positioned) or isinstance(value, Positioned):
                    return True
            case If(head, body) | For(_, head, body):
                if isinstance(head, Positioned) or reads_first(body):
                    return True
            case _:
                assert_never(statement)
    return False


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

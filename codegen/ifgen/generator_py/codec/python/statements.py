"""The statements of codecs, and which of them matter.

They are named tuples, which are made in half the time of frozen dataclasses: a large message has 100,000 of
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias, assert_never

from ifgen.generator_py.codec.python.code import Positioned


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

"""Functions of a codec, statement after statement, and the constants at the level of its module."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeAlias

from ifgen.definition.types import NamespacedType
from ifgen.generator_py.codec.statements import (
    POSITION,
    Assign,
    Choice,
    Do,
    For,
    If,
    Move,
    Place,
    Positioned,
    Refuse,
    Return,
    Statement,
    lines_of,
    without_idle_moves,
    wrapped,
)


class Body:
    """The statements of a function, in the order in which they are added."""

    def __init__(self) -> None:
        self._statements: list[Statement] = []
        self._pending_moves: list[str | int] = []
        self._variables = 0

    def name(self, prefix: str) -> str:
        """A new name for a local variable."""
        self._variables += 1
        return f"{prefix}{self._variables}"

    def do(self, statement: str) -> None:
        """Add a statement that gives nothing a name."""
        self._move_for(statement)
        self._statements.append(Do(statement))

    def assign(self, target: str, value: str) -> None:
        """Add `target = value`."""
        self._move_for(target, value)
        self._statements.append(Assign(target, value))

    def give(self, result: str) -> None:
        """Return the result; a variable that got its value just now is left out."""
        self._move_for(result)
        match self._statements[-1:]:
            case [Assign(target, value)] if target == result:
                self._statements[-1] = Return(value)
            case [Place(value)] if result == POSITION:
                self._statements[-1] = Return(value)
            case _:
                self._statements.append(Return(result))

    def refuse(self, conditions: Sequence[str]) -> None:
        """Leave the fast path if one of the conditions holds."""
        if conditions:
            self._move_now()
            condition = " or ".join(conditions)
            has_position = any(isinstance(part, Positioned) for part in conditions)
            self._statements.append(Refuse(Positioned(condition) if has_position else condition))

    def move(self, distance: str | int) -> None:
        """Add `p += distance`, not before it is needed."""
        self._pending_moves.append(distance)

    def place(self, position: str) -> None:
        """Add `p = position`."""
        self._move_for(position)
        self._pending_moves.clear()
        self._statements.append(Place(position))

    def choose(self, condition: str, body: Sequence[Assign | Do], otherwise: Sequence[Assign | Do]) -> None:
        """Do one or the other. Both read the position, and move it within expressions only."""
        self._move_now()
        self._statements.append(Choice(condition, tuple(body), tuple(otherwise)))

    @contextmanager
    def when(self, condition: str) -> Generator[None]:
        """Do what is added meanwhile if the condition holds."""
        with self._inside() as (outer, inner):
            yield
        outer.append(If(condition, tuple(inner)))

    @contextmanager
    def each(self, variable: str, values: str) -> Generator[None]:
        """Do what is added meanwhile for each of the values."""
        with self._inside() as (outer, inner):
            yield
        outer.append(For(variable, values, tuple(inner)))

    def lines(self, indent: int) -> list[str]:
        """The finished lines, without the updates of a position that nothing reads."""
        return lines_of(without_idle_moves(self._statements), indent)

    def _move_for(self, *values: str) -> None:
        """Add pending moves, if one of the values contains the position."""
        if self._pending_moves and any(isinstance(value, Positioned) for value in values):
            self._move_now()

    def _move_now(self) -> None:
        distances = [distance for distance in self._pending_moves if isinstance(distance, str)]
        known = sum(distance for distance in self._pending_moves if isinstance(distance, int))
        if known:
            distances.append(str(known))
        if distances:
            self._statements.append(Move(" + ".join(distances)))
        self._pending_moves.clear()

    @contextmanager
    def _inside(self) -> Generator[tuple[list[Statement], list[Statement]]]:
        self._move_now()
        outer, inner = self._statements, list[Statement]()
        self._statements = inner
        try:
            yield outer, inner
            self._move_now()
        finally:
            self._statements = outer


class Constants:
    """Module-level constants of one class's codec, each made once, and the names that the codec imports."""

    def __init__(self, class_name: str) -> None:
        self._prefix = f"_{class_name}_"
        self._names: dict[str, str] = {}
        self._imported: set[str] = set()

    def runtime(self, name: str) -> str:
        """A name of `ifgen_runtime.codec`, to be imported."""
        self._imported.add(name)
        return name

    def name(self, value: str) -> str:
        """The name of the constant with this value."""
        return self._names.setdefault(value, f"{self._prefix}{len(self._names)}")

    def layout(self, maker: str, layout: str) -> str:
        """The name of `maker("<layout")`: a function for a little-endian `struct` layout."""
        return self.name(f'{self.runtime(maker)}("<{layout}")')

    @property
    def imported(self) -> tuple[str, ...]:
        """The names that `runtime` was asked for, sorted."""
        return tuple(sorted(self._imported))

    @property
    def lines(self) -> tuple[str, ...]:
        """The assignments, in the order of first use."""
        return tuple(line for value, name in self._names.items() for line in wrapped(f"{name} = {value}", 0))


Reference: TypeAlias = Callable[[NamespacedType], str]
"""The name of a message class in the module."""


def functions(name: str, arguments: str, bodies: Iterable[Body]) -> Iterator[str]:
    """A function of these arguments that returns a new value of the last one, `p`.

    Where it has several bodies, each is a function of its own, and they are called one after another.
    """
    texts = [body.lines(1) for body in bodies]
    if len(texts) > 1:
        calls = [f"{name}_{number}({arguments})" for number in range(1, len(texts) + 1)]
        for call, lines in zip(calls, texts, strict=True):
            yield "\n".join([f"def {call}:", *lines])
        texts = [[*(f"    p = {call}" for call in calls[:-1]), f"    return {calls[-1]}"]]
    yield "\n".join([f"def {name}({arguments}):", *texts[0]])

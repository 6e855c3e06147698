"""Python text for the codec: statements, blocks, module-level constants, and how long lines are broken."""

from __future__ import annotations

import re
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TypeAlias

LINE_LENGTH = 104  # the text stands in an `if not TYPE_CHECKING`
_POSITION = re.compile(r"\bp\b")
_BREAK = re.compile(r"(?<=,) | (?=(?:or|and|for|if|\+) )")


@dataclass(frozen=True, slots=True)
class Line:
    """One statement; `moves` if all it does is to update the position `p`, `reads` if it reads `p`."""

    text: str
    moves: bool = False
    reads: bool = False


@dataclass(slots=True)
class Block:
    """A `for` or an `if` and what is below it."""

    head: str
    body: list[Entry] = field(default_factory=list["Entry"])


Entry: TypeAlias = Line | Block


class Body:
    """The statements of a function, in the order in which they are added."""

    def __init__(self) -> None:
        self._entries: list[Entry] = []
        self._pending_moves: list[str] = []

    def add(self, text: str) -> None:
        """Add a statement."""
        reads = _mentions_position(text)
        if reads:
            self._move_now()
        self._entries.append(Line(text, reads=reads))

    def give(self, expression: str) -> None:
        """Add `return`, in place of the statement that has just given the expression its name."""
        if _mentions_position(expression):
            self._move_now()
        last = self._entries[-1] if self._entries else None
        if isinstance(last, Line) and last.text.startswith(f"{expression} = "):
            self._entries.pop()
            expression = last.text.removeprefix(f"{expression} = ")
        self.add(f"return {expression}")

    def move(self, amount: str) -> None:
        """Add `p += amount`, not before it is needed."""
        self._pending_moves.append(amount)

    def place(self, position: str) -> None:
        """Add `p = position`."""
        reads = _mentions_position(position)
        if reads:
            self._move_now()
        self._pending_moves.clear()
        self._entries.append(Line(f"p = {position}", moves=True, reads=reads))

    def _move_now(self) -> None:
        known = sum(int(amount) for amount in self._pending_moves if amount.isdigit())
        amounts = [amount for amount in self._pending_moves if not amount.isdigit()]
        if known:
            amounts.append(str(known))
        if amounts:
            self._entries.append(Line(f"p += {' + '.join(amounts)}", moves=True, reads=True))
        self._pending_moves.clear()

    def refuse(self, conditions: Iterable[str]) -> None:
        """Leave the fast path if one of the conditions holds."""
        text = " or ".join(conditions)
        if text:
            with self.block(f"if {text}:"):
                self.add("raise TypeError")

    @contextmanager
    def block(self, head: str) -> Generator[None]:
        """Put what is added meanwhile into a block."""
        self._move_now()
        outer, block = self._entries, Block(head)
        outer.append(block)
        self._entries = block.body
        try:
            yield
            self._move_now()
        finally:
            self._entries = outer

    def lines(self, indent: int) -> list[str]:
        """The finished lines, without updates of a position that nothing reads."""
        kept, _ = _without_idle_moves(self._entries, False, {})
        return list(_rendered(kept, indent))


def _mentions_position(text: str) -> bool:
    return _POSITION.search(text) is not None


_Kept: TypeAlias = dict[tuple[int, bool], tuple[list[Entry], bool]]
"""Results of `_without_idle_moves`, by the identity of the entries and whether `p` is read later."""


def _without_idle_moves(entries: Sequence[Entry], read_later: bool, known: _Kept) -> tuple[list[Entry], bool]:
    """The entries that matter, and whether `p` is read in them (or later) before it is set.

    What is known is not asked again: each block asks twice for what is in it, and so would each in that.
    """
    if (id(entries), read_later) in known:
        return known[id(entries), read_later]
    kept: list[Entry] = []
    live = read_later
    for entry in reversed(entries):
        if isinstance(entry, Block):
            in_head = _mentions_position(entry.head)
            _, again = _without_idle_moves(entry.body, live, known)
            body, entered = _without_idle_moves(entry.body, live or again, known)
            live = live or entered or in_head
            if body:
                kept.append(Block(entry.head, body))
        elif not entry.moves or live:
            live = entry.reads or (live and not entry.moves)
            kept.append(entry)
    known[id(entries), read_later] = found = kept[::-1], live
    return found


def _rendered(entries: Iterable[Entry], indent: int) -> Iterator[str]:
    for entry in entries:
        if isinstance(entry, Line):
            yield from wrapped(entry.text, indent)
        else:
            yield from wrapped(entry.head, indent)
            yield from _rendered(entry.body, indent + 1)


def wrapped(text: str, indent: int) -> Iterator[str]:
    """The statement on one line, or broken inside brackets where it is too long."""
    margin = "    " * indent
    if len(margin) + len(text) <= LINE_LENGTH:
        yield margin + text
        return
    if text.startswith("if "):
        text = f"if ({text[3:-1]}):"
    line, depth = margin, 0
    room = LINE_LENGTH - len(margin) - 4
    for word in (word for part in _BREAK.split(text) for word in _fitting(part, room)):
        if depth and len(line) + len(word) > LINE_LENGTH:
            yield line.rstrip()
            line = margin + "    "
        line += word + " "
        depth += sum(map(word.count, "([{")) - sum(map(word.count, ")]}"))
    yield line.rstrip()


def _fitting(part: str, room: int) -> list[str]:
    return [part] if len(part) <= room else part.split(" ")


def functions(name: str, arguments: str, bodies: Iterable[Body]) -> Iterator[str]:
    """A function of these arguments that returns a new value of the last one, `p`.

    If it has several bodies, each is a separate function, and they are called one after another.
    """
    texts = [body.lines(1) for body in bodies]
    if len(texts) > 1:
        calls = [f"{name}_{number}({arguments})" for number in range(1, len(texts) + 1)]
        for call, lines in zip(calls, texts, strict=True):
            yield "\n".join([f"def {call}:", *lines])
        texts = [[*(f"    p = {call}" for call in calls[:-1]), f"    return {calls[-1]}"]]
    yield "\n".join([f"def {name}({arguments}):", *texts[0]])


class Constants:
    """Module-level constants of one class's codec, each made once, and the names that it imports."""

    def __init__(self, class_name: str) -> None:
        self._prefix = f"_{class_name}_"
        self._names: dict[str, str] = {}
        self._imported: set[str] = set()

    def runtime(self, name: str) -> str:
        """Something of `ifgen_runtime.codec`, to be imported."""
        self._imported.add(name)
        return name

    def name(self, expression: str) -> str:
        """The name of the constant with this value."""
        return self._names.setdefault(expression, f"{self._prefix}{len(self._names)}")

    def layout(self, maker: str, text: str) -> str:
        """The name of `maker("<text")`: a function for a little-endian `struct` layout."""
        return self.name(f'{self.runtime(maker)}("<{text}")')

    @property
    def imported(self) -> tuple[str, ...]:
        """The names that `runtime` was asked for, sorted."""
        return tuple(sorted(self._imported))

    @property
    def lines(self) -> tuple[str, ...]:
        """The assignments, in the order of first use."""
        return tuple(
            line for expression, name in self._names.items() for line in wrapped(f"{name} = {expression}", 0)
        )

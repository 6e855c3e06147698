"""From the text of a CMake file to its commands and blocks, as cmake-language(7) has them.

Written by hand rather than with lark: the language has one kind of statement, which regular expressions take
apart in linear time, and every `ifgen generate` reads these files.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

MAX_NESTING: Final = 50

_BLOCKS: Final = frozenset({"if", "foreach", "while", "function", "macro", "block"})

_SPACE: Final = re.compile(r"(?:[ \t\r\n]+|\#\[(=*)\[.*?\]\1\]|\#(?!\[=*\[)[^\n]*)*", re.DOTALL)
_COMMAND: Final = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)[ \t]*(\()?")
_ARGUMENT: Final = re.compile(
    r"""
    \[ (?P<level> =* ) \[ \n? (?P<brackets> .*? ) \] (?P=level) \]
  | (?P<parenthesis> [()] )
  | " (?P<quotes> (?: [^"\\] | \\. )* ) "
  | (?P<none> (?! \[=*\[ ) (?: [^\s()\#"\\] | \\. ) (?: [^\s()\#"\\] | \\. | "(?: [^"\\\n] | \\. )*" )* )
    """,
    re.VERBOSE | re.DOTALL,
)
_CONTINUED_LINE: Final = re.compile(r"(?<!\\)((?:\\\\)*)\\\n")


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument as it is written: `text` without its quotes or brackets."""

    text: str
    quoting: Literal["none", "quotes", "brackets"]


@dataclass(frozen=True, slots=True)
class Command:
    """One command invocation, with its name in lower case: CMake ignores the case."""

    name: str
    arguments: tuple[Argument, ...]
    start: int


@dataclass(slots=True)
class Block:
    """A command that opens a block, and what is in it; `otherwise` are the `elseif` and `else` of an `if`."""

    command: Command
    body: list[Statement] = field(default_factory=list["Statement"])
    otherwise: list[Block] = field(default_factory=list["Block"])


Statement = Command | Block


class SyntaxProblem(Exception):
    """A text is no CMake file, from this offset on."""

    def __init__(self, message: str, offset: int) -> None:
        super().__init__(message)
        self.offset = offset


def commands(text: str) -> Iterator[Command]:
    """The commands of a file, in order. Raises SyntaxProblem."""
    at = _after_space(text, 1 if text.startswith("\ufeff") else 0)
    while at < len(text):
        match = _COMMAND.match(text, at)
        if match is None:
            raise SyntaxProblem("a command was expected", at)
        if match[2] is None:
            raise SyntaxProblem(f"a `(` was expected after {match[1]}", match.end())
        arguments, end = _arguments(text, match.end(), at)
        yield Command(match[1].lower(), tuple(arguments), at)
        at = _after_space(text, end)


def _after_space(text: str, at: int) -> int:
    """The offset after space and comments."""
    match = _SPACE.match(text, at)
    return match.end() if match else at


def _arguments(text: str, at: int, start: int) -> tuple[list[Argument], int]:
    """The arguments up to the parenthesis that closes; those within are arguments of their own."""
    found: list[Argument] = []
    depth = 1
    while (at := _after_space(text, at)) < len(text):
        token = _ARGUMENT.match(text, at)
        if token is None:
            is_bracket = text.startswith("[", at)
            raise SyntaxProblem("this bracket has no end" if is_bracket else "this is not CMake", at)
        at = token.end()
        match token.lastgroup:
            case "brackets":
                found.append(Argument(token["brackets"], "brackets"))
            case "quotes":
                found.append(Argument(_CONTINUED_LINE.sub(r"\1", token["quotes"]), "quotes"))
            case kind:
                if kind == "parenthesis":
                    depth += 1 if token[0] == "(" else -1
                if not depth:
                    return found, at
                found.append(Argument(token[0], "none"))
    raise SyntaxProblem("the `)` of this command is missing", start)


def statements(text: str) -> list[Statement]:
    """The commands of a file, those of a block inside their block. Raises SyntaxProblem."""
    bodies: list[list[Statement]] = [[]]
    blocks: list[Block] = []
    for command in commands(text):
        name = command.name
        if name in _BLOCKS:
            block = Block(command)
            bodies[-1].append(block)
            blocks.append(block)
            bodies.append(block.body)
            if len(blocks) > MAX_NESTING:
                raise SyntaxProblem("blocks are too deep within one another", command.start)
        elif name in {"else", "elseif"}:
            if not blocks or blocks[-1].command.name != "if":
                raise SyntaxProblem(f"there is no `if` for this `{name}`", command.start)
            branch = Block(command)
            blocks[-1].otherwise.append(branch)
            bodies[-1] = branch.body
        elif name.startswith("end") and name[3:] in _BLOCKS:
            if not blocks or blocks.pop().command.name != name[3:]:
                raise SyntaxProblem(f"there is no block that this `{name}` ends", command.start)
            bodies.pop()
        else:
            bodies[-1].append(command)
    if blocks:
        unclosed = blocks[-1].command
        raise SyntaxProblem(f"this `{unclosed.name}` has no end", unclosed.start)
    return bodies[0]


def commands_in(statements: Sequence[Statement]) -> Iterator[Command]:
    """All commands, those in blocks included."""
    for statement in statements:
        if isinstance(statement, Command):
            yield statement
        else:
            yield statement.command
            yield from commands_in([*statement.body, *statement.otherwise])

"""From the commands of a CMake file to its blocks: conditions, loops and definitions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from ifgen.reading.cmake.text import Command, SyntaxProblem

MAX_NESTING: Final = 50

_ENDS: Final = {
    "if": "endif",
    "foreach": "endforeach",
    "while": "endwhile",
    "function": "endfunction",
    "macro": "endmacro",
    "block": "endblock",
}
_CLOSING: Final = frozenset(_ENDS.values())


@dataclass(slots=True)
class Block:
    """A command that opens a block, and what is in it; `otherwise` are the `elseif` and `else` of an `if`."""

    command: Command
    body: list[Statement] = field(default_factory=list["Statement"])
    otherwise: list[Block] = field(default_factory=list["Block"])


Statement = Command | Block


def blocks(commands: Sequence[Command]) -> list[Statement]:
    """The commands, those of a block inside their block. Raises SyntaxProblem if blocks do not match."""
    top: list[Statement] = []
    open_blocks: list[Block] = []
    body = top
    for command in commands:
        if command.name in _ENDS:
            block = Block(command)
            body.append(block)
            open_blocks.append(block)
            body = block.body
            if len(open_blocks) > MAX_NESTING:
                raise SyntaxProblem("blocks are too deep within one another", command.start)
        elif command.name in {"else", "elseif"}:
            if not open_blocks or open_blocks[-1].command.name != "if":
                raise SyntaxProblem(f"there is no `if` for this `{command.name}`", command.start)
            branch = Block(command)
            open_blocks[-1].otherwise.append(branch)
            body = branch.body
        elif command.name in _CLOSING:
            if not open_blocks or _ENDS[open_blocks[-1].command.name] != command.name:
                raise SyntaxProblem(f"there is no block that this `{command.name}` ends", command.start)
            open_blocks.pop()
            body = _innermost(open_blocks, top)
        else:
            body.append(command)
    if open_blocks:
        raise SyntaxProblem(
            f"this `{open_blocks[-1].command.name}` has no end", open_blocks[-1].command.start
        )
    return top


def _innermost(open_blocks: Sequence[Block], top: list[Statement]) -> list[Statement]:
    if not open_blocks:
        return top
    block = open_blocks[-1]
    return block.otherwise[-1].body if block.otherwise else block.body


def commands_in(statements: Sequence[Statement]) -> Iterator[Command]:
    """All commands, those in blocks included."""
    pending = list(reversed(statements))
    while pending:
        statement = pending.pop()
        if isinstance(statement, Command):
            yield statement
        else:
            yield statement.command
            pending += reversed([*statement.body, *statement.otherwise])

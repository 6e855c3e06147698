"""A CMake file as a program: its statements, and the text that they stand in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ifgen.diagnostics import Source
from ifgen.reading.cmake.blocks import Statement, blocks
from ifgen.reading.cmake.text import commands


@dataclass(frozen=True, slots=True)
class Program:
    """The statements of a file."""

    source: Source
    statements: Sequence[Statement]


def parsed(source: Source, spend: Callable[[int], None]) -> Program:
    """The program in a text, paid for with `spend`. Raises SyntaxProblem, and what `spend` raises."""
    statements = blocks(commands(source.text))
    spend(len(source.text) // 10)
    return Program(source, statements)

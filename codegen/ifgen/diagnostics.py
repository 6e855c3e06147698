"""Mistakes in interfaces, as values. Nothing here prints.

A stage collects every `Diagnostic` that it can find and raises them together as one `InputError`.
How they look (a terminal, JSON, CI annotations) is `command_kit/report.py`'s business.
"""

from __future__ import annotations

import unicodedata
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final, Literal

Severity = Literal["error", "warning"]

MAX_PROBLEMS: Final = 20
"""Findings that are reported for one file; the rest are only counted."""


@dataclass(frozen=True)
class Source:
    """One interface file: where it is and what it says (decoded, as written).

    `revision` is the name of the revision that it was read from; None if it was read from disk.
    """

    path: Path
    text: str = field(repr=False)
    revision: str | None = None

    @cached_property
    def _line_starts(self) -> list[int]:
        starts: list[int] = []
        offset = 0
        for line in self.text.splitlines(keepends=True):
            starts.append(offset)
            offset += len(line)
        return starts or [0]

    def position(self, offset: int) -> tuple[int, int]:
        """The line and column of a character offset, both counted from 1."""
        index = max(bisect_right(self._line_starts, offset) - 1, 0)
        return index + 1, offset - self._line_starts[index] + 1

    def line(self, number: int) -> str:
        """The text of a line (counted from 1) without its line break; empty past the end."""
        lines = self.text.splitlines()
        return lines[number - 1] if number <= len(lines) else ""


@dataclass(frozen=True, slots=True)
class Span:
    """Characters `start` to `end` (exclusive) of a source."""

    source: Source
    start: int
    end: int

    @property
    def line(self) -> int:
        """The line on which the span starts, counted from 1."""
        return self.source.position(self.start)[0]

    @property
    def column(self) -> int:
        """The column in which the span starts, counted from 1."""
        return self.source.position(self.start)[1]


@dataclass(frozen=True, slots=True)
class Label:
    """A place and what is to be said about it."""

    span: Span
    text: str = ""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding: `rule` is a word id such as `unknown-type`, `message` one sentence without a full stop.

    `primary` is None only where no file can be blamed (a missing folder, say). `breaks` has the categories of
    a difference between two versions: `source`, `hash`, `wire`.
    """

    rule: str
    message: str
    primary: Label | None = None
    secondary: tuple[Label, ...] = ()
    help: str | None = None
    severity: Severity = "error"
    breaks: tuple[str, ...] = ()


def any_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether one of them is an error."""
    return any(diagnostic.severity == "error" for diagnostic in diagnostics)


class InputError(Exception):
    """All mistakes in what ifgen was given to read, in `diagnostics`.

    That is interfaces and descriptions of nodes, templates, packages, and files that are in the way.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics: tuple[Diagnostic, ...] = tuple(diagnostics)
        super().__init__("\n".join(_in_words(diagnostic) for diagnostic in self.diagnostics))


class UsageError(InputError):
    """The request is impossible: a wrong configuration, or an unknown name."""


def _in_words(diagnostic: Diagnostic) -> str:
    place = ""
    if diagnostic.primary is not None:
        span = diagnostic.primary.span
        place = f"{span.source.path}:{span.line}:{span.column}: "
    help = f"\n  help: {diagnostic.help}" if diagnostic.help else ""
    return f"{place}{diagnostic.severity}[{diagnostic.rule}]: {diagnostic.message}{help}"


def shown_source(source: Source) -> str:
    """The path of a source as people want to read it, after its revision if it has one."""
    path = shown_path(source.path)
    return path if source.revision is None else f"{source.revision}:{path}"


def shorten(text: str, limit: int = 60) -> str:
    """A text of any length, shortened for a message."""
    return text if len(text) <= limit else text[: limit - 3] + "..."


def shown_path(path: Path) -> str:
    """The path as people want to read it: relative to the working directory where it lies below it."""
    try:
        return str(path.absolute().relative_to(Path.cwd()))
    except (ValueError, OSError):
        return str(path)


def shown_character(character: str) -> str:
    """The character as a terminal may get it: four spaces for a tab, a picture for what could steer it."""
    if character == "\t":
        return "    "
    if character < " ":
        return chr(0x2400 + ord(character))  # the picture of a control character: U+241B for an escape
    steers = unicodedata.category(character) in {"Cc", "Cf", "Cs", "Zl", "Zp"}
    is_none = ord(character) & 0xFFFE == 0xFFFE  # U+FFFE and its like, which no text may have
    return "\N{REPLACEMENT CHARACTER}" if steers or is_none else character


def printable(text: str) -> str:
    """Text from an input file or path without anything that could steer a terminal."""
    if text.isascii() and text.replace("\n", "").isprintable():
        return text
    return "".join(c if c == "\n" else shown_character(c) for c in text)


def near_names(name: str, candidates: Iterable[str], *, limit: int = 1, cutoff: float = 0.6) -> list[str]:
    """The candidates that are spelled most like `name`, at most `limit`, the nearest first."""
    from difflib import get_close_matches  # late: only a mistake needs it

    return get_close_matches(name[:80], list(candidates), limit, cutoff)


def did_you_mean(
    name: str, candidates: Iterable[str], *, form: str = "'{}'", limit: int = 1, cutoff: float = 0.6
) -> str:
    """Advice that names what is spelled like `name`, each in its `form`; empty if nothing is."""
    near = near_names(name, candidates, limit=limit, cutoff=cutoff)
    return f"did you mean {' or '.join(map(form.format, near))}?" if near else ""

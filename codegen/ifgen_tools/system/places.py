"""Places in launch files: the line that made an action, and within it the word that a finding is about."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from ifgen.diagnostics import InputError, Source, Span
from ifgen.reading.storage import read_source

Place = tuple[str, int]
"""A file, and a line counted from 1, as `launch` has them."""


class Places:
    """The texts of launch files, each read once, and spans in them."""

    def __init__(self) -> None:
        self._sources: dict[str, Source | None] = {}

    def span(self, place: Place | None, *words: str) -> Span | None:
        """The first of these words in the action made at a place, else its line; None without a file."""
        source = self.source(place[0]) if place else None
        if source is None or place is None:
            return None
        line = Span(source, *_line(source, place[1]))
        for word in filter(None, words):
            for start, end in _extents(source, place[1]):
                if found := _find(source, word, start, end):
                    return found
        for word in filter(None, words):
            everywhere = list(_quoted(source, word, 0, len(source.text)))
            if len(everywhere) == 1:
                return everywhere[0]
        return line

    def source(self, path: str) -> Source | None:
        """The text of a file; None if it cannot be read."""
        if path not in self._sources:
            try:
                self._sources[path] = read_source(Path(path))
            except InputError:
                self._sources[path] = None
        return self._sources[path]


def _line(source: Source, number: int) -> tuple[int, int]:
    """The characters of a line, without those around its text."""
    start = _start(source, number)
    text = source.line(number)
    return start + len(text) - len(text.lstrip()), start + len(text.rstrip())


def _start(source: Source, number: int) -> int:
    return sum(map(len, source.text.splitlines(keepends=True)[: number - 1]))


def _extents(source: Source, number: int) -> Iterator[tuple[int, int]]:
    """The characters of what begins on a line, the smallest first: a call, an element, or a part of YAML."""
    start = _start(source, number)
    if source.path.suffix == ".py":
        for last, column in sorted(_calls(source.text).get(number, ())):
            yield start, _start(source, last) + column
        return
    text = source.text[start:]
    if source.path.suffix in {".yaml", ".yml"}:
        first = text.partition("\n")[0]
        indent = len(first) - len(first.lstrip())
        end = re.search(rf"\n(?=[ ]{{0,{indent}}}[^\s])", text)
        yield start, start + (end.start() if end else len(text))
    elif tag := re.match(r"\s*<([\w-]+)", text):
        closed = re.match(r"[^>]*/>", text)
        end = closed or re.search(rf"</{re.escape(tag[1])}\s*>", text)
        yield start, start + (end.end() if end else len(text))


@cache
def _calls(text: str) -> dict[int, list[tuple[int, int]]]:
    """For each line the ends (line, column) of the calls that begin there."""
    found: dict[int, list[tuple[int, int]]] = {}
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return found
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and node.end_lineno and node.end_col_offset:
            found.setdefault(node.lineno, []).append((node.end_lineno, node.end_col_offset))
    return found


def _find(source: Source, word: str, start: int, end: int) -> Span | None:
    """A word in quotes, else one that stands alone."""
    if found := next(_quoted(source, word, start, end), None):
        return found
    alone = re.compile(rf"(?<![\w/~.]){re.escape(word)}(?![\w/.])").search(source.text, start, end)
    return Span(source, alone.start(), alone.end()) if alone else None


def _quoted(source: Source, word: str, start: int, end: int) -> Iterator[Span]:
    for found in re.compile(rf"""(["']){re.escape(word)}\1""").finditer(source.text, start, end):
        yield Span(source, found.start() + 1, found.end() - 1)

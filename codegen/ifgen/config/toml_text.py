"""The text of a pyproject.toml: parsed, and with the places of its keys, which tomllib does not report."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, TypeAlias

from ifgen.config.keys import Mistake
from ifgen.diagnostics import Diagnostic, Label, Source, Span, UsageError, shown_path
from ifgen.reading.storage import read_limited

_DEEPEST: Final = 100
"""Parts of a dotted key: tomllib takes a time and a memory that are quadratic in their number."""

_WORD: Final = r"""(?:(?<![\w-])[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_LONG_KEY: Final = re.compile(rf"(?:{_WORD}\.[ \t]*+){{{_DEEPEST}}}")

_Key: TypeAlias = tuple[str, ...]

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"""[ \t]*("(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[A-Za-z0-9_-]+)[ \t]*""")
_TEXT = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|' + r"'''.*?'{3,5}|" + r'"(?:[^"\\\n]|\\.)*"|' + r"'[^'\n]*'", re.DOTALL
)
_SCALAR = re.compile(r"[^,\]}\n#]*")


def read_source(path: Path) -> Source:
    """The text of a pyproject.toml. Raises UsageError if it cannot be read."""
    try:
        return Source(path, read_limited(path).decode("utf-8").replace("\r\n", "\n"))
    except UnicodeDecodeError:
        problem = "is not UTF-8"
    except OSError as error:
        problem = f"cannot be read: {error.strerror}"
    raise UsageError([Diagnostic("configuration", f"{path} {problem}")])


def parse(source: Source) -> dict[str, Any]:
    """The document in a pyproject.toml. Raises UsageError if it is no TOML, or nested beyond measure."""
    if found := _LONG_KEY.search(source.text):
        span = Span(source, *found.span())
        raise _beyond_measure(source, f"a key has more than {_DEEPEST} parts", Label(span))
    try:
        return tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        raise UsageError([_syntax(source, error)]) from None
    except RecursionError:
        raise _beyond_measure(source, "lists or tables are nested too deeply") from None
    except ValueError:
        raise _beyond_measure(source, "a number has thousands of digits") from None


def _beyond_measure(source: Source, what: str, label: Label | None = None) -> UsageError:
    message = f"{shown_path(source.path)} cannot be read: {what}"
    return UsageError([Diagnostic("configuration", message, label)])


def _syntax(source: Source, error: tomllib.TOMLDecodeError) -> Diagnostic:
    """The message of the TOML parser, with its place."""
    # Before Python 3.14 the place stands in the message alone.
    place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
    message = str(error)[: place.start()].strip() if place else str(error)
    end = len(source.text.rstrip())
    start = _offset(source, int(place[1]), int(place[2])) if place else max(end - 1, 0)
    label = Label(Span(source, start, start + 1), message[:1].lower() + message[1:])
    return Diagnostic("configuration", f"{source.path.name} is not valid TOML", label)


def diagnostic(source: Source, mistake: Mistake) -> Diagnostic:
    """A mistake in `[tool.ifgen]` with its place."""
    place = find_key(source, mistake.path)
    if mistake.word is not None:
        word = re.compile(rf"""["']{re.escape(mistake.word)}["']""").search(source.text, place.end)
        place = Span(source, *word.span()) if word else place
    return Diagnostic("configuration", mistake.message, Label(place, mistake.label), help=mistake.help)


def find_key(source: Source, path: Sequence[str]) -> Span:
    """The place of a key below [tool.ifgen], or of the innermost table around it."""
    known = places(source.text)
    keys = ("tool", "ifgen", *path)
    while keys and keys not in known:
        keys = keys[:-1]
    return Span(source, *known.get(keys, (0, 0)))


def _offset(source: Source, line: int, column: int) -> int:
    lines = source.text.split("\n")
    return sum(len(text) + 1 for text in lines[: line - 1]) + column - 1


@lru_cache(maxsize=2)  # each target and output has several keys with places, in one file
def places(text: str) -> Mapping[_Key, tuple[int, int]]:
    """The first place (start, end) of each key and table of a valid document, by its path."""
    found: dict[_Key, tuple[int, int]] = {}
    for path, span in _Scanner(text).document():
        found.setdefault(path, span)
    return found


class _Scanner:
    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def document(self) -> Iterator[tuple[_Key, tuple[int, int]]]:
        table: _Key = ()
        while self._skip(_BLANK) < len(self._text):
            before = self._at
            if self._text.startswith("[", self._at):
                self._at += 2 if self._text.startswith("[[", self._at) else 1
                keys = list(self._keys(()))
                yield from keys
                table = keys[-1][0] if keys else ()
                self._skip(re.compile(r"\]*"))
            else:
                yield from self._pair(table)
            self._at = max(self._at, before + 1)

    def _pair(self, table: _Key) -> Iterator[tuple[_Key, tuple[int, int]]]:
        keys = list(self._keys(table))
        yield from keys
        if self._text.startswith("=", self._at):
            self._at += 1
            yield from self._value(keys[-1][0] if keys else table)

    def _keys(self, table: _Key) -> Iterator[tuple[_Key, tuple[int, int]]]:
        """The parts of `a."b".c`, each with all that stand before it."""
        while key := _KEY.match(self._text, self._at):
            table = (*table, key[1].strip("\"'"))
            self._at = key.end()
            yield table, key.span(1)
            if not self._text.startswith(".", self._at):
                return
            self._at += 1

    def _value(self, path: _Key) -> Iterator[tuple[_Key, tuple[int, int]]]:
        self._skip(_BLANK)
        opening = self._text[self._at : self._at + 1]
        if opening not in {"[", "{"}:
            self._skip(_TEXT if opening in {'"', "'"} else _SCALAR)
            return
        self._at += 1
        while self._skip(_BLANK) < len(self._text) and self._text[self._at] not in "]}":
            before = self._at
            yield from self._pair(path) if opening == "{" else self._value(path)
            self._skip(_BLANK)
            self._at = max(self._at + self._text.startswith(",", self._at), before + 1)
        self._at += 1

    def _skip(self, pattern: re.Pattern[str]) -> int:
        match = pattern.match(self._text, self._at)
        self._at = match.end() if match else self._at
        return self._at

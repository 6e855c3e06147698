"""The places of the keys in a TOML document, which tomllib does not report."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TypeAlias

Path: TypeAlias = tuple[str, ...]

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"""[ \t]*("(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[A-Za-z0-9_-]+)[ \t]*""")
_TEXT = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|' + r"'''.*?'{3,5}|" + r'"(?:[^"\\\n]|\\.)*"|' + r"'[^'\n]*'", re.DOTALL
)
_SCALAR = re.compile(r"[^,\]}\n#]*")


def places(text: str) -> dict[Path, tuple[int, int]]:
    """The first place (start, end) of each key and table of a valid document, by its path."""
    found: dict[Path, tuple[int, int]] = {}
    for path, span in _Scanner(text).document():
        found.setdefault(path, span)
    return found


class _Scanner:
    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def document(self) -> Iterator[tuple[Path, tuple[int, int]]]:
        table: Path = ()
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

    def _pair(self, table: Path) -> Iterator[tuple[Path, tuple[int, int]]]:
        keys = list(self._keys(table))
        yield from keys
        if self._text.startswith("=", self._at):
            self._at += 1
            yield from self._value(keys[-1][0] if keys else table)

    def _keys(self, table: Path) -> Iterator[tuple[Path, tuple[int, int]]]:
        """The parts of `a."b".c`, each with all that stand before it."""
        while key := _KEY.match(self._text, self._at):
            table = (*table, key[1].strip("\"'"))
            self._at = key.end()
            yield table, key.span(1)
            if not self._text.startswith(".", self._at):
                return
            self._at += 1

    def _value(self, path: Path) -> Iterator[tuple[Path, tuple[int, int]]]:
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

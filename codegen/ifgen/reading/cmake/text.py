"""From the text of a CMake file to its commands and their arguments, as cmake-language(7) has them.

Written by hand rather than with lark: the language has one kind of statement, which one regular expression
takes apart in linear time, and every `ifgen generate` reads these files.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

Quoting = Literal["none", "quotes", "brackets"]

_TOKEN: Final = re.compile(
    r"""
    (?P<space> [ \t\r\n]+ )
  | (?P<bracket> \#? \[ (?P<level> =* ) \[ )
  | (?P<comment> \# [^\n]* )
  | (?P<open> \( )
  | (?P<close> \) )
  | " (?P<quoted> (?: [^"\\] | \\. )* ) "
  | (?P<plain> (?: [^\s()\#"\\] | \\. ) (?: [^\s()\#"\\] | \\. | "(?: [^"\\\n] | \\. )*" )* )
    """,
    re.VERBOSE | re.DOTALL,
)
_NAME: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_CONTINUED_LINE: Final = re.compile(r"(?<!\\)((?:\\\\)*)\\\n")


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument as it is written: `text` without its quotes or brackets."""

    text: str
    quoting: Quoting
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Command:
    """One command invocation, with its name in lower case: CMake ignores the case."""

    name: str
    arguments: tuple[Argument, ...]
    start: int
    end: int


class SyntaxProblem(Exception):
    """A text is no CMake file, from this offset on."""

    def __init__(self, message: str, offset: int) -> None:
        super().__init__(message)
        self.offset = offset


def commands(text: str) -> list[Command]:
    """The commands of a file, in order. Raises SyntaxProblem."""
    found: list[Command] = []
    tokens = _Tokens(text)
    for kind, start, end, _ in tokens:
        name = text[start:end]
        if kind != "plain" or not _NAME.fullmatch(name):
            raise SyntaxProblem("a command was expected", start)
        opening = tokens.next_on_this_line()
        if opening != "open":
            raise SyntaxProblem(f"a `(` was expected after {name}", end)
        arguments = tuple(_arguments(tokens, start))
        found.append(Command(name.lower(), arguments, start, tokens.at))
    return found


def _arguments(tokens: _Tokens, start: int) -> Iterator[Argument]:
    """The arguments up to the parenthesis that closes; those within are arguments of their own."""
    depth = 1
    for kind, begin, end, text in tokens:
        if kind in {"open", "close"}:
            depth += 1 if kind == "open" else -1
            if not depth:
                return
        quoting: Quoting = "quotes" if kind == "quoted" else "brackets" if kind == "bracket" else "none"
        yield Argument(text, quoting, begin, end)
    raise SyntaxProblem("the `)` of this command is missing", start)


class _Tokens:
    """The rest of a text, without space and comments: (kind, start, end, text)."""

    def __init__(self, text: str) -> None:
        self._text = text
        self.at = 1 if text.startswith("\ufeff") else 0

    def __iter__(self) -> Iterator[tuple[str, int, int, str]]:
        while self.at < len(self._text):
            start = self.at
            kind, text = self._next()
            if kind not in {"space", "comment"}:
                yield kind, start, self.at, text

    def next_on_this_line(self) -> str:
        """The kind of what comes after spaces."""
        while self._text.startswith((" ", "\t"), self.at):
            self.at += 1
        return self._next()[0] if self.at < len(self._text) else ""

    def _next(self) -> tuple[str, str]:
        match = _TOKEN.match(self._text, self.at)
        if match is None:
            raise SyntaxProblem("this is not CMake", self.at)
        self.at = match.end()
        kind = match.lastgroup or ""
        if kind == "bracket":
            return self._bracket(match)
        if kind == "quoted":
            return kind, _CONTINUED_LINE.sub(r"\1", match[kind])
        return kind, match[0]

    def _bracket(self, match: re.Match[str]) -> tuple[str, str]:
        """A bracket argument or comment, whose first line break does not count."""
        closing = f"]{match['level']}]"
        end = self._text.find(closing, self.at)
        is_comment = match[0].startswith("#")
        if end < 0:
            raise SyntaxProblem(f"the `{closing}` of this bracket is missing", match.start())
        content = self._text[self.at : end]
        self.at = end + len(closing)
        return ("comment", "") if is_comment else ("bracket", content.removeprefix("\n"))

"""The place where the syntax of an .idl file is wrong, and what is around it."""

from __future__ import annotations

import re
from collections.abc import Sequence, Set
from dataclasses import dataclass
from typing import Final

from ifgen.diagnostics import Label, Source, Span

CLOSING: Final = {"(": ")", "[": "]", "<": ">"}
"""The brackets inside a definition or a member."""

_TOKEN: Final = re.compile(
    r'//[^\n]*|/\*[\s\S]+?\*/|\s+|(?P<text>"(?:[^"\\\n]|\\[^\n])*"|\w+|::|[^\w\s])',
)


@dataclass(frozen=True, slots=True)
class Token:
    """A token and where it is; its text is empty where there is none."""

    text: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Place:
    """The place where the parser stopped: the token there, those before it, and the expected terminals."""

    source: Source
    found: Token
    before: Sequence[Token]
    expected: Set[str]

    @classmethod
    def at(cls, source: Source, position: int, expected: Set[str]) -> Place:
        """Look at what is around a position; linear in the text before it."""
        text = source.text
        before = [
            Token(match["text"], match.start(), match.end())
            for match in _TOKEN.finditer(text, 0, position)
            if match["text"]
        ]
        match = _TOKEN.match(text, position)
        end = len(text.rstrip())
        found = Token("", end, end)
        if match and match["text"]:
            found = Token(match["text"], position, match.end())
        return cls(source, found, before, expected)

    def last(self, number: int = 1) -> Token:
        """The token at the given distance before the place."""
        return self.before[-number] if number <= len(self.before) else Token("", 0, 0)

    def expects(self, terminal: str) -> bool:
        """Whether a terminal would have been right."""
        return terminal in self.expected

    @property
    def in_struct(self) -> bool:
        """Whether a member would have been right."""
        return self.expects("RBRACE") and self.expects("SEQUENCE")

    def statement(self) -> Sequence[Token]:
        """The tokens since the last definition or member ended, or a brace began a new list of them."""
        start = len(self.before)
        while start and self.before[start - 1].text not in {";", "{", "}"}:
            start -= 1
        return self.before[start:]

    def struct(self) -> str:
        """The name of the struct that the place is in; empty outside of structs."""
        depth = 0
        for index in range(len(self.before) - 1, 1, -1):
            text = self.before[index].text
            depth += (text == "{") - (text == "}")
            if depth > 0:
                return self.before[index - 1].text if self.before[index - 2].text == "struct" else ""
        return ""

    def open_bracket(self) -> Token | None:
        """The innermost bracket of the statement that is still open."""
        opened: list[Token] = []
        for token in self.statement():
            if token.text in CLOSING:
                opened.append(token)
            elif opened and token.text == CLOSING[opened[-1].text]:
                opened.pop()
        return opened[-1] if opened else None

    def brace(self, *, closed: bool) -> tuple[Label, ...]:
        """The brace that the last token closes, or the last one that nothing closes; empty without one."""
        opened: list[Token] = []
        last: Token | None = None
        for token in self.before:
            if token.text == "{":
                opened.append(token)
            elif token.text == "}" and opened:
                last = opened.pop()
        found = last if closed else opened[-1] if opened else None
        return (Label(self.span(found), "opened here"),) if found else ()

    def span(self, token: Token) -> Span:
        """The place of a token."""
        return Span(self.source, token.start, token.end)

    def after_last(self) -> Span:
        """The place right after the last token."""
        return Span(self.source, self.last().end, self.last().end)

    def match(self, pattern: str) -> re.Match[str] | None:
        """Match the text from the place on."""
        return re.compile(pattern).match(self.source.text, self.found.start)

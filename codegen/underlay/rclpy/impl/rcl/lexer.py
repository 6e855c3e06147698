"""The words that remap, parameter and log-level rules are made of.

`n:rostopic://chatter:=/a/b` is TOKEN COLON URL_TOPIC TOKEN SEPARATOR SLASH TOKEN SLASH TOKEN END.
The numbers of the lexemes are part of the error texts users see.
"""

from __future__ import annotations

import re
from enum import IntEnum

__all__ = ["Lexeme", "Lexer", "RuleError"]


class RuleError(ValueError):
    """A rule of the command line does not follow its grammar; the text says where."""


class Lexeme(IntEnum):
    """The kind of a piece of a rule."""

    NONE = 0
    END = 1
    TILDE_SLASH = 2
    URL_SERVICE = 3
    URL_TOPIC = 4
    COLON = 5
    NODE = 6
    NAMESPACE = 7
    SEPARATOR = 8
    BACKREFERENCE = 9
    TOKEN = 18
    SLASH = 19
    WILD_ONE = 20
    WILD_MULTI = 21
    DOT = 22


# Order matters: the first that matches wins. A token stops before a second underscore in a row.
_WORDS = re.compile(
    r"(?P<URL_SERVICE>rosservice://)|(?P<URL_TOPIC>rostopic://)|(?P<TILDE_SLASH>~/)|(?P<NODE>__node|__name)"
    r"|(?P<NAMESPACE>__ns)|(?P<SEPARATOR>:=)|(?P<COLON>:)|(?P<BACKREFERENCE>\\[1-9])"
    r"|(?P<TOKEN>(?!__)[A-Za-z_](?:[A-Za-z0-9]|(?<!_)_)*)|(?P<SLASH>/)|(?P<WILD_MULTI>\*\*)|(?P<WILD_ONE>\*)"
    r"|(?P<DOT>\.)"
)


class Lexer:
    """Reads a rule from left to right with as much look-ahead as the grammars need."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0

    def _word_at(self, position: int) -> tuple[Lexeme, int]:
        if position >= len(self.text):
            return Lexeme.END, position
        found = _WORDS.match(self.text, position)
        if found is None or found.lastgroup is None:
            return Lexeme.NONE, position
        return Lexeme[found.lastgroup], found.end()

    def peek(self) -> Lexeme:
        """The next lexeme, not consumed."""
        return self._word_at(self.position)[0]

    def peek2(self) -> tuple[Lexeme, Lexeme]:
        """The next two lexemes, not consumed."""
        first, end = self._word_at(self.position)
        return first, self._word_at(end)[0]

    def accept(self) -> str:
        """Consume the next lexeme and return its text."""
        start = self.position
        self.position = self._word_at(start)[1]
        return self.text[start : self.position]

    def expect(self, wanted: Lexeme) -> str:
        """Consume the next lexeme, which must be `wanted`; raises RuleError."""
        found = self.peek()
        if found is wanted:
            return self.accept()
        if found in (Lexeme.NONE, Lexeme.END):
            raise RuleError(
                f"Expected lexeme type ({wanted:d}) not found, search ended at index {self.position}"
            )
        raise RuleError(f"Expected lexeme type {wanted:d}, got {found:d} at index {self.position}")

    def rest(self) -> str:
        """The text that is not consumed yet."""
        return self.text[self.position :]

    def node_prefix(self) -> str | None:
        """The node that `node:` at the front restricts the rule to, consumed; None without one."""
        if self.peek2() != (Lexeme.TOKEN, Lexeme.COLON):
            return None
        name = self.accept()
        self.accept()
        return name

    def refuse_wildcards(self) -> None:
        """Raise RuleError unless a token may start here; wildcards are ROS's plan, not its practice."""
        found = self.peek()
        if found is Lexeme.WILD_ONE:
            raise RuleError("Wildcard '*' is not implemented")
        if found is Lexeme.WILD_MULTI:
            raise RuleError("Wildcard '**' is not implemented")
        if found not in (Lexeme.TOKEN, Lexeme.SLASH):
            raise RuleError("Expecting token or wildcard")

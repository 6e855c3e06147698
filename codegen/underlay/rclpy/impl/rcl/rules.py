"""Rules of the command line: the words that they are made of, and what remap rules do to names."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum, IntEnum, auto

from .names import expand_name


class RuleError(ValueError):
    """A rule of the command line does not follow its grammar; the text says where."""


class Lexeme(IntEnum):
    """The kind of a piece of a rule; its number is part of error texts."""

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
    """Reads a rule from left to right with as much look-ahead as the grammars need.

    `n:rostopic://chatter:=/a/b` is TOKEN COLON URL_TOPIC TOKEN SEPARATOR SLASH TOKEN SLASH TOKEN END.
    """

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


class RemapKind(Enum):
    """The kind of name that a rule changes."""

    NODE_NAME = auto()
    NAMESPACE = auto()
    TOPIC = auto()
    SERVICE = auto()
    TOPIC_AND_SERVICE = auto()


@dataclass(frozen=True, slots=True)
class RemapRule:
    """A rule such as `chatter:=talk` or `n:__ns:=/s`.

    `node` restricts it to nodes of that name, `match` is empty for node names and namespaces.
    """

    kind: RemapKind
    node: str | None
    match: str
    replacement: str


def parse_remap_rule(text: str, warn: Callable[[str], None]) -> RemapRule:
    """Read one rule; raises RuleError. `warn` hears about names that make a rule useless."""
    lexer = Lexer(text)
    node = lexer.node_prefix()
    match lexer.peek():
        case Lexeme.NODE:
            return RemapRule(RemapKind.NODE_NAME, node, "", _node_name(lexer, warn))
        case Lexeme.NAMESPACE:
            return RemapRule(RemapKind.NAMESPACE, node, "", _namespace(lexer, warn))
        case _:
            kind, match = _match_side(lexer)
            return RemapRule(kind, node, match, _replacement_side(lexer))


def _node_name(lexer: Lexer, warn: Callable[[str], None]) -> str:
    lexer.accept()
    lexer.expect(Lexeme.SEPARATOR)
    if lexer.peek() is not Lexeme.TOKEN:
        warn(f"Node name not remapped to invalid name: '{lexer.rest()}'")
    name = lexer.expect(Lexeme.TOKEN)
    lexer.expect(Lexeme.END)
    return name


def _namespace(lexer: Lexer, warn: Callable[[str], None]) -> str:
    lexer.accept()
    lexer.expect(Lexeme.SEPARATOR)
    start = lexer.position
    try:
        lexer.expect(Lexeme.SLASH)
        while lexer.peek() is Lexeme.TOKEN:
            lexer.accept()
            if lexer.peek() is Lexeme.SLASH:
                lexer.accept()
        lexer.expect(Lexeme.END)
    except RuleError:
        warn(f"Namespace not remapped to a fully qualified name (found: {lexer.text[start:]})")
        raise
    return lexer.text[start:]


_KIND_OF_URL = {Lexeme.URL_TOPIC: RemapKind.TOPIC, Lexeme.URL_SERVICE: RemapKind.SERVICE}


def _match_side(lexer: Lexer) -> tuple[RemapKind, str]:
    kind = _KIND_OF_URL.get(lexer.peek(), RemapKind.TOPIC_AND_SERVICE)
    if kind is not RemapKind.TOPIC_AND_SERVICE:
        lexer.accept()
    start = lexer.position
    if lexer.peek() in (Lexeme.TILDE_SLASH, Lexeme.SLASH):
        lexer.accept()
    while True:
        if lexer.peek() is Lexeme.SLASH:
            raise RuleError("Expecting token or wildcard")
        lexer.refuse_wildcards()
        lexer.accept()
        if lexer.peek() is Lexeme.SEPARATOR:
            break
        lexer.expect(Lexeme.SLASH)
    match = lexer.text[start : lexer.position]
    lexer.accept()
    return kind, match


def _replacement_side(lexer: Lexer) -> str:
    start = lexer.position
    if lexer.peek() in (Lexeme.TILDE_SLASH, Lexeme.SLASH):
        lexer.accept()
    while True:
        found = lexer.peek()
        if found is Lexeme.BACKREFERENCE:
            raise RuleError("Backreferences are not implemented")
        if found is not Lexeme.TOKEN:
            raise RuleError("error not set")  # the C layer says no more than this
        lexer.accept()
        if lexer.peek() is Lexeme.END:
            return lexer.text[start:]
        lexer.expect(Lexeme.SLASH)


def remapped_name(rules: Iterable[RemapRule], kind: RemapKind, node_name: str) -> str | None:
    """The node name or namespace in the first rule for this node; None without one."""
    for rule in rules:
        if rule.kind is kind and rule.node in (None, node_name):
            return rule.replacement
    return None


def remapped_topic(
    rules: Iterable[RemapRule], full_name: str, *, is_service: bool, node_name: str, namespace: str
) -> str:
    """An absolute topic or service name after the first matching rule; unchanged without one.

    Both sides of a rule are read as the node would read them (relative, private).
    """
    kinds = (RemapKind.TOPIC_AND_SERVICE, RemapKind.SERVICE if is_service else RemapKind.TOPIC)
    for rule in rules:
        if rule.kind not in kinds or rule.node not in (None, node_name):
            continue
        if expand_name(rule.match, node_name, namespace) == full_name:
            return expand_name(rule.replacement, node_name, namespace)
    return full_name

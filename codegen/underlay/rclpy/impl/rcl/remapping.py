"""Remap rules: `chatter:=talk`, `node:~/x:=y`, `__node:=n`, `__ns:=/s`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum, auto

from .lexer import Lexeme, Lexer, RuleError
from .names import expand_name

__all__ = ["RemapKind", "RemapRule", "parse_remap_rule", "remapped_name", "remapped_topic"]


class RemapKind(Enum):
    """The kind of name that a rule changes."""

    NODE_NAME = auto()
    NAMESPACE = auto()
    TOPIC = auto()
    SERVICE = auto()
    TOPIC_AND_SERVICE = auto()


@dataclass(frozen=True, slots=True)
class RemapRule:
    """One rule; `node` restricts it to nodes of that name, `match` is empty for node names and namespaces."""

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

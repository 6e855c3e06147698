"""The tree of a NoDL document, from YAML or JSON, before its meaning: values with their places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, TypeAlias

from ifgen.diagnostics import Span

MAX_CHARACTERS: Final = 300_000
"""The longest document that is read: some ten thousand lines."""

MAX_VALUES: Final = 50_000
"""The limit on values in a document, counting aliased values at each use."""

MAX_DEPTH: Final = 40
"""Lists and maps inside each other; NoDL itself needs six."""


@dataclass(frozen=True, slots=True)
class Foreign:
    """A value that YAML has but JSON lacks, such as a date."""

    kind: str


@dataclass(frozen=True, slots=True)
class ScalarNode:
    """A text, number, truth value or null; `plain` if it stands there without quotes.

    `written` is the text of a plain one in YAML, which a parameter file may read otherwise.
    """

    value: str | int | float | bool | Foreign | None
    span: Span
    plain: bool = True
    written: str | None = None


@dataclass(frozen=True, slots=True)
class Key:
    """A key of a map and where it stands."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class ListNode:
    """A list; `size` counts the values in it and itself."""

    items: tuple[Node, ...]
    span: Span
    size: int = 1


@dataclass(frozen=True, slots=True)
class MapNode:
    """A map, with unique keys in their order; `size` counts its values and itself."""

    entries: tuple[tuple[Key, Node], ...]
    span: Span
    size: int = 1

    def get(self, name: str) -> Node | None:
        """The value of a key; None if it has no such key."""
        return next((value for key, value in self.entries if key.name == name), None)

    def key(self, name: str) -> Key | None:
        """A key with its place; None if it has no such key."""
        return next((key for key, _ in self.entries if key.name == name), None)


Node: TypeAlias = ScalarNode | ListNode | MapNode


def size_of(node: Node) -> int:
    """The number of values that a node stands for."""
    return 1 if isinstance(node, ScalarNode) else node.size


def plain_value(node: Node) -> object:
    """A node as Python's own dicts, lists and scalars."""
    match node:
        case ScalarNode(value):
            return value
        case ListNode(items):
            return [plain_value(item) for item in items]
        case MapNode(entries):
            return {key.name: plain_value(value) for key, value in entries}


def shown(node: Node) -> str:
    """A node in a few words."""
    match node:
        case ListNode(items):
            return "a list" if items else "an empty list"
        case MapNode(entries):
            return "a map" if entries else "an empty map"
        case ScalarNode(None):
            return "nothing"
        case ScalarNode(bool() as value):
            return f"the boolean {str(value).lower()}"
        case ScalarNode(int()):
            return "an integer"
        case ScalarNode(float()):
            return "a number"
        case ScalarNode(Foreign(kind)):
            return kind
        case ScalarNode():
            return "a text"

"""The tree of a NoDL document: values with their places, and the taking of what belongs there out of it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias, get_args

from ifgen.definition.explain import did_you_mean
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Label, Span, shorten

_JSON_NUMBER: Final = re.compile(r"[-+]?\d+(\.\d+)?[eE][-+]?\d+")

_OCTAL: Final = re.compile(r"0o[0-7]+")


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


def source_text(node: Node) -> str:
    """A node as it is in the file."""
    return node.span.source.text[node.span.start : node.span.end]


def table(
    node: Node, what: str, known: Sequence[str], required: Iterable[str], problems: FileProblems
) -> MapNode | None:
    """The map that a node must be, with its keys checked; None if it is none."""
    if not isinstance(node, MapNode):
        problems.error(wrong_value, node, what, f"a map with the keys {', '.join(known)}")
        return None
    for key, _ in node.entries:
        if key.name not in known:
            problems.error(unknown_key, key, what, known)
    for name in required:
        if node.get(name) is None:
            problems.error(missing_key, name, what, node.span)
    return node


def entries(parent: MapNode, key: str, expected: str, problems: FileProblems) -> MapNode | None:
    """The map under a key; None if there is none."""
    node = parent.get(key)
    if node is None or isinstance(node, MapNode):
        return node
    problems.error(wrong_value, node, f"`{key}`", expected)
    return None


def items(parent: MapNode, key: str, expected: str, problems: FileProblems) -> tuple[Node, ...]:
    """The items of the list under a key; none if there is no such key."""
    node = parent.get(key)
    if isinstance(node, ListNode):
        return node.items
    if node is not None:
        problems.error(wrong_value, node, f"`{key}`", expected)
    return ()


def text(parent: MapNode, key: str, problems: FileProblems) -> str | None:
    """The text under a key; None if there is none."""
    node = parent.get(key)
    if node is None:
        return None
    if isinstance(node, ScalarNode) and isinstance(node.value, str):
        return node.value
    problems.error(wrong_value, node, f"`{key}`", "a text")
    return None


def flag(parent: MapNode, key: str, problems: FileProblems) -> bool:
    """Whether a key says `true`."""
    node = parent.get(key)
    if node is None:
        return False
    if isinstance(node, ScalarNode) and isinstance(node.value, bool):
        return node.value
    problems.error(wrong_value, node, f"`{key}`", "true or false")
    return False


def integer(parent: MapNode, key: str, minimum: int, maximum: int, problems: FileProblems) -> int:
    """The integer under a key, 0 if there is none."""
    node = parent.get(key)
    if node is None:
        return 0
    match node:
        # JSON Schema takes 5.0 for an integer.
        case ScalarNode(int() | float() as value) if not isinstance(value, bool) and value % 1 == 0:
            if minimum <= value <= maximum:
                return int(value)
            problems.error(out_of_range, node, f"`{key}`", minimum, maximum)
            return max(minimum, min(maximum, int(value)))
        case _:
            pass
    problems.error(wrong_value, node, f"`{key}`", f"an integer from {minimum} to {maximum}")
    return 0


def choice(parent: MapNode, key: str, options: object, problems: FileProblems) -> str | None:
    """The word under a key, which must be one of a Literal's; None if it is none, or not there."""
    node = parent.get(key)
    if node is None:
        return None
    known: tuple[str, ...] = get_args(options)
    if isinstance(node, ScalarNode) and isinstance(node.value, str):
        if node.value in known:
            return node.value
        problems.error(unknown_choice, node, f"`{key}`", known)
    else:
        problems.error(wrong_value, node, f"`{key}`", f"one of the texts {', '.join(known)}")
    return None


def unknown_key(key: Key, what: str, known: Iterable[str]) -> Diagnostic:
    """Say that a map cannot have a key."""
    known = list(known)
    return Diagnostic(
        "unknown-key",
        f"{what} has no key `{shorten(key.name)}`",
        Label(key.span, "unknown key"),
        help=did_you_mean(key.name, known) or f"the keys are {', '.join(known)}",
    )


def missing_key(name: str, what: str, span: Span, help: str | None = None) -> Diagnostic:
    """Say that a map lacks a key."""
    return Diagnostic("missing-key", f"{what} needs the key `{name}`", Label(span), help=help)


def wrong_value(node: Node, name: str, expected: str) -> Diagnostic:
    """Say that a value is not of the kind that belongs there."""
    return Diagnostic(
        "wrong-value",
        f"{name} must be {expected}",
        Label(node.span, f"this is {shown(node)}"),
        help=yaml_surprise(node, expected),
    )


def out_of_range(node: ScalarNode, name: str, minimum: int, maximum: int) -> Diagnostic:
    """Say that an integer is too small or too large."""
    assert isinstance(node.value, int | float)
    is_small = node.value < minimum
    limit = f"{minimum} or more" if is_small else f"{maximum} or less"
    return Diagnostic(
        "wrong-value" if is_small else "too-large-number",
        f"{name} must be {limit}",
        Label(node.span, f"this is {shorten(source_text(node))}"),
        help="to leave it open, write 0 or leave out the key" if minimum == 0 else None,
    )


def unknown_choice(node: ScalarNode, name: str, options: Iterable[str]) -> Diagnostic:
    """Say that a value is none of those that there are."""
    options = list(options)
    value = str(node.value)
    close = did_you_mean(value.upper() if options[0].isupper() else value, options)
    listed = f"{', '.join(options[:-1])} or {options[-1]}" if len(options) > 1 else options[0]
    return Diagnostic(
        "unknown-value", f"{name} must be {listed}, not `{shorten(value)}`", Label(node.span), help=close
    )


def yaml_surprise(node: Node, expected: str) -> str | None:
    """Advice for a word that YAML reads differently from people."""
    if not isinstance(node, ScalarNode) or not node.plain:
        return None
    written = source_text(node)
    if isinstance(node.value, str):
        if "number" not in expected and "integer" not in expected:
            return None
        is_of_int = "64 bits" in expected  # a parameter, of which no float is a value
        if _JSON_NUMBER.fullmatch(written) and not is_of_int:
            return f"YAML 1.1 takes `{shorten(written)}` for a text: write `{_as_float(written)}`"
        if _OCTAL.fullmatch(written):
            return f"YAML 1.1 takes `{shorten(written)}` for a text: write `{int(written, 8)}`"
        return None
    if "text" in expected and node.value is not None:
        return f'YAML takes `{shorten(written)}` for {shown(node)}: write it in quotes, "{shorten(written)}"'
    return None


def _as_float(written: str) -> str:
    """A number of JSON as YAML 1.1 wants it: 1e3 is 1.0e+3."""
    mantissa, _, power = written.lower().partition("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{power if power[0] in '+-' else '+' + power}"

"""Takes values out of maps, and says which keys are unknown or missing and which values of a wrong kind."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import get_args

from ifgen.definition.problems import FileProblems
from ifgen.nodl.syntax import explain
from ifgen.nodl.syntax.tree import ListNode, MapNode, Node, ScalarNode


def table(
    node: Node, what: str, known: Sequence[str], required: Iterable[str], problems: FileProblems
) -> MapNode | None:
    """The map that a node must be, with its keys checked; None if it is none."""
    if not isinstance(node, MapNode):
        problems.error(explain.wrong_value, node, what, f"a map with the keys {', '.join(known)}")
        return None
    for key, _ in node.entries:
        if key.name not in known:
            problems.error(explain.unknown_key, key, what, known)
    for name in required:
        if node.get(name) is None:
            problems.error(explain.missing_key, name, what, node.span)
    return node


def entries(parent: MapNode, key: str, expected: str, problems: FileProblems) -> MapNode | None:
    """The map under a key; None if there is none."""
    node = parent.get(key)
    if node is None or isinstance(node, MapNode):
        return node
    problems.error(explain.wrong_value, node, f"`{key}`", expected)
    return None


def items(parent: MapNode, key: str, expected: str, problems: FileProblems) -> tuple[Node, ...]:
    """The items of the list under a key; none if there is no such key."""
    node = parent.get(key)
    if isinstance(node, ListNode):
        return node.items
    if node is not None:
        problems.error(explain.wrong_value, node, f"`{key}`", expected)
    return ()


def text(parent: MapNode, key: str, problems: FileProblems) -> str | None:
    """The text under a key; None if there is none."""
    node = parent.get(key)
    if node is None:
        return None
    if isinstance(node, ScalarNode) and isinstance(node.value, str):
        return node.value
    problems.error(explain.wrong_value, node, f"`{key}`", "a text")
    return None


def flag(parent: MapNode, key: str, problems: FileProblems) -> bool:
    """Whether a key says `true`."""
    node = parent.get(key)
    if node is None:
        return False
    if isinstance(node, ScalarNode) and isinstance(node.value, bool):
        return node.value
    problems.error(explain.wrong_value, node, f"`{key}`", "true or false")
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
            problems.error(explain.out_of_range, node, f"`{key}`", minimum, maximum)
            return 0
        case _:
            pass
    problems.error(explain.wrong_value, node, f"`{key}`", f"an integer from {minimum} to {maximum}")
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
        problems.error(explain.unknown_choice, node, f"`{key}`", known)
    else:
        problems.error(explain.wrong_value, node, f"`{key}`", f"one of the texts {', '.join(known)}")
    return None

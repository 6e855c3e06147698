"""From the text of an interface file to its tree, in time linear in the text, whatever that holds."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, Final, NamedTuple, Protocol, TypeAlias

from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, Source, Span
from ifgen.idl import comments, explain
from ifgen.idl.tables import parse_function
from ifgen.idl.tree import ConstantNode, DefinitionNode, FieldNode, InterfaceTree, PartNode

MAX_DEFINITIONS: Final = 20_000
"""Definitions in one file beyond which it is refused; the largest known one has a few hundred."""

OPTIONAL: Final = "@optional"
"""The annotation that rosidl reads before a definition since ROS 2 Lyrical."""

# Line breaks of str.splitlines() other than "\n" and "\r\n"; rosidl_adapter splits the text with it.
_OTHER_BREAK: Final = re.compile("[\v\f\x1c-\x1e\x85\u2028\u2029]|\r(?!\n)")
_DEFINITION_LINE: Final = re.compile(r"^[^\S\n]*+[^\s#]", re.MULTILINE)
_NOTHING: Final = PartNode((), ())


class _Token(Protocol):
    """The part of lark's tokens that we use, the same in lark 1.x and lark-parser 0.12."""

    value: str
    start_pos: int


class _Refused(NamedTuple):
    """A line, or its rest after the type, that is not a definition, and a function that explains why."""

    start: int
    end: int
    explain: Callable[[Source, int, int], Diagnostic]


class _Optional(NamedTuple):
    """An `@optional` and where it is."""

    start: int


class _Parsed(NamedTuple):
    """A file's separators, its parts, and the lines that belong to none."""

    separators: Sequence[_Token]
    parts: list[PartNode]
    refused: list[_Refused]


_Line: TypeAlias = tuple[DefinitionNode | _Refused | _Optional, str]
"""A definition and the text from its end on: comments of a definition start above it."""


class _TreeBuilder:
    """Called by lark while it parses, once a line, so that no tree of lark's own is ever built."""

    def field(self, tokens: list[_Token]) -> _Line:
        head, *default, end = tokens
        type_text, name, start = _divided(head)
        if default:
            text = default[0].value
            value = text.lstrip()
            value_start = default[0].start_pos + len(text) - len(value)
            node = FieldNode(type_text, head.start_pos, name, start, value.rstrip(), value_start, ())
        else:
            node = FieldNode(type_text, head.start_pos, name.rstrip(), start, None, 0, ())
        return node, end.value

    def constant(self, tokens: list[_Token]) -> _Line:
        head, assigned, end = tokens
        type_text, name, start = _divided(head)
        value = assigned.value.lstrip()[1:].lstrip()
        value_start = assigned.start_pos + len(assigned.value) - len(value)
        node = ConstantNode(type_text, head.start_pos, name.rstrip(), start, value.rstrip(), value_start, ())
        return node, end.value

    def refused_line(self, tokens: list[_Token]) -> _Line:
        line, end = tokens
        return _Refused(line.start_pos, end.start_pos, explain.refused_line), end.value

    def refused_constant(self, tokens: list[_Token]) -> _Line:
        head, _, end = tokens
        return _Refused(_divided(head)[2], end.start_pos, explain.refused_constant), end.value

    def optional(self, tokens: list[_Token]) -> _Line:
        mark, *end = tokens
        return _Optional(mark.start_pos), end[0].value if end else ""

    def part(self, children: list[Any]) -> tuple[PartNode, list[_Refused]]:
        own: list[str] = []
        pending: list[str] = []
        if children and type(children[0]) is not tuple:
            own, pending = comments.split_lead(children.pop(0).value)
        definitions: list[DefinitionNode] = []
        refused: list[_Refused] = []
        optionals: list[int] = []
        optional = False
        for node, end in children:
            following: list[str] = []
            if "#" in end:
                trailing, following = comments.split_end(end)
                pending += trailing
            if type(node) is _Optional:
                if optional:
                    refused.append(_Refused(node.start, node.start + len(OPTIONAL), explain.second_optional))
                optionals.append(node.start)
                optional = True
                pending += following  # belongs to what is optional
                continue
            if type(node) is _Refused:
                refused.append(node)
            else:
                if optional and type(node) is FieldNode:
                    node = node._replace(optional=True)  # noqa: PLW2901
                definitions.append(node._replace(comments=pending) if pending else node)
            optional = False
            pending = following
        return PartNode(own, definitions, optionals), refused

    def interface(self, children: list[Any]) -> _Parsed:
        parts = children[::2]
        return _Parsed(
            children[1::2], [part for part, _ in parts], [line for _, bad in parts for line in bad]
        )


def _divided(head: _Token) -> tuple[str, str, int]:
    """The type, the name, and where the name starts."""
    type_text, _, rest = head.value.partition(" ")
    name = rest.lstrip()
    return type_text, name, head.start_pos + len(head.value) - len(name)


@lru_cache(maxsize=1)
def _parser() -> Callable[[str], _Parsed]:
    return parse_function("interface", "interface", _TreeBuilder())


def parse_message(source: Source) -> InterfaceTree:
    """The tree of a `.msg` file: one part."""
    return _parse(source, 1)


def parse_service(source: Source) -> InterfaceTree:
    """The tree of a `.srv` file: request and response."""
    return _parse(source, 2)


def parse_action(source: Source) -> InterfaceTree:
    """The tree of an `.action` file: goal, result and feedback."""
    return _parse(source, 3)


def _parse(source: Source, number_of_parts: int) -> InterfaceTree:
    """Parse; the tree has `number_of_parts` parts, empty ones where separators are missing."""
    problems: list[Diagnostic] = []
    text = _prepare(source.text)
    if text.startswith("\ufeff"):
        problems.append(explain.byte_order_mark(source))
        text = "\n" + text[1:]
    limit = _definition_limit(text)
    if limit is not None:
        place = Span(source, limit, text.index("\n", limit))
        problems.append(explain.too_many_definitions(place, MAX_DEFINITIONS))
        text = text[:limit]
    separators, parts, refused = _parser()(text) if text else _Parsed((), [_NOTHING], [])
    problems += [line.explain(source, line.start, line.end) for line in refused[:MAX_PROBLEMS]]
    if len(parts) != number_of_parts and limit is None and not _has_bad_separator(problems):
        spans = [Span(source, token.start_pos, token.start_pos + 3) for token in separators]
        problems.append(explain.wrong_separators(source, spans, number_of_parts - 1))
    parts = (parts + [_NOTHING] * number_of_parts)[:number_of_parts]
    return InterfaceTree(source, tuple(parts), tuple(problems), max(len(refused) - MAX_PROBLEMS, 0))


def _has_bad_separator(problems: Sequence[Diagnostic]) -> bool:
    """Whether a line that was meant as a separator has been refused: reason enough for their number."""
    return any(problem.rule == "bad-separator" for problem in problems)


def _prepare(text: str) -> str:
    """Make tabs spaces, and all line breaks of `splitlines` ones that the grammar knows; offsets stay."""
    if "\t" in text:
        text = text.replace("\t", " ")
    if _OTHER_BREAK.search(text):
        text = _OTHER_BREAK.sub("\n", text)
    return text if not text or text.endswith("\n") else text + "\n"


def _definition_limit(text: str) -> int | None:
    """The place of the first definition beyond the limit, if there is one."""
    if text.count("\n") <= MAX_DEFINITIONS:
        return None
    for number, match in enumerate(_DEFINITION_LINE.finditer(text), 1):
        if number > MAX_DEFINITIONS:
            return match.start()
    return None

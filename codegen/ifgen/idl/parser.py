"""From the text of a `.msg`, `.srv` or `.action` file to its tree, in time linear in the text whatever it holds."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NamedTuple

from lark import Lark, Token, Transformer

from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, Label, Source, Span
from ifgen.idl import comments, explain
from ifgen.idl.tree import ConstantNode, DefinitionNode, FieldNode, InterfaceTree, PartNode

MAX_DEFINITIONS: Final = 20_000
"""Definitions in one file beyond which it is refused; the largest known one has a few hundred."""

# Line breaks of str.splitlines() other than "\n" and "\r\n"; rosidl_adapter splits the text with it.
_OTHER_BREAK: Final = re.compile("[\v\f\x1c-\x1e\x85\u2028\u2029]|\r(?!\n)")
_DEFINITION_LINE: Final = re.compile(r"^[^#\n]", re.MULTILINE)


class _Refused(NamedTuple):
    """A line, or what follows its type and name, that cannot be a definition; the offsets cover the bad words."""

    start: int
    end: int


class _TreeBuilder(Transformer):  # type: ignore[type-arg, misc]  # lark-parser 0.12 has no generic parameters
    """Called by lark while it parses: one call a line, so that no tree of lark's own is ever built.

    Lines come as (node, end of line) because the comments of a definition start above it.
    """

    def field(self, tokens: list[Token]) -> tuple[FieldNode, Token]:
        type_, name, *default, end = tokens
        written = name.lstrip()
        name_start = name.start_pos + len(name) - len(written)
        if not default:
            return FieldNode(type_.value, type_.start_pos, written.rstrip(), name_start, None, 0, ()), end
        value = default[0].lstrip()
        value_start = default[0].start_pos + len(default[0]) - len(value)
        node = FieldNode(type_.value, type_.start_pos, written, name_start, value.rstrip(), value_start, ())
        return node, end

    def constant(self, tokens: list[Token]) -> tuple[ConstantNode, Token]:
        type_, name, assigned, end = tokens
        written = name.strip()
        name_start = name.start_pos + len(name) - len(name.lstrip())
        value = assigned.lstrip()[1:].lstrip()
        value_start = assigned.start_pos + len(assigned) - len(value)
        node = ConstantNode(
            type_.value, type_.start_pos, written, name_start, value.rstrip(), value_start, ()
        )
        return node, end

    def refused(self, tokens: list[Token]) -> tuple[_Refused, Token]:
        first, end = tokens[0], tokens[-1]
        return _Refused(first.start_pos, end.start_pos), end

    def part(self, children: list[Any]) -> tuple[PartNode, list[_Refused]]:
        own: list[str] = []
        pending: list[str] = []
        if children and isinstance(children[0], Token):
            own, pending = comments.split_lead(children[0].value)
            del children[0]
        definitions: list[DefinitionNode] = []
        refused: list[_Refused] = []
        for node, end in children:
            if "#" in end:
                trailing, following = comments.split_end(end.value)
                pending += trailing
            else:
                following = []
            if type(node) is _Refused:
                refused.append(node)
            else:
                definitions.append(node._replace(comments=pending) if pending else node)
            pending = following
        return PartNode(own, definitions), refused

    def interface(self, children: list[Any]) -> tuple[list[Token], list[tuple[PartNode, list[_Refused]]]]:
        return children[1::2], children[::2]


@lru_cache(maxsize=1)
def _parser() -> Callable[[str], Any]:
    grammar = (Path(__file__).parent / "interface.lark").read_text(encoding="utf-8")
    # Placeholders are on by default in lark 1.x and off in lark-parser 0.12.
    return Lark(
        grammar, parser="lalr", start="interface", maybe_placeholders=False, transformer=_TreeBuilder()
    ).parse


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
    limit = _definition_limit(text)
    if limit is not None:
        place = Span(source, limit, text.index("\n", limit))
        problems.append(explain.too_many_definitions(place, MAX_DEFINITIONS))
        text = text[:limit]
    separators, children = _parser()(text) if text else ([], [(PartNode((), ()), [])])
    parts = [part for part, _ in children]
    refused = [line for _, lines in children for line in lines]
    problems[:0] = [explain.refused_line(source, line.start, line.end) for line in refused[:MAX_PROBLEMS]]
    if len(parts) != number_of_parts and limit is None:
        spans = [Span(source, token.start_pos, token.start_pos + 3) for token in separators]
        problems.append(explain.wrong_separators(source, spans, number_of_parts - 1))
        parts = (parts + [PartNode((), ())] * number_of_parts)[:number_of_parts]
    return InterfaceTree(source, tuple(parts), tuple(problems), max(len(refused) - MAX_PROBLEMS, 0))


def _prepare(text: str) -> str:
    """Make tabs spaces and every line break of `splitlines` one that the grammar knows; offsets stay the same."""
    if "\t" in text:
        text = text.replace("\t", " ")
    if _OTHER_BREAK.search(text):
        text = _OTHER_BREAK.sub("\n", text)
    return text if not text or text.endswith("\n") else text + "\n"


def _definition_limit(text: str) -> int | None:
    """Where the first definition too many starts, if there is one."""
    if text.count("\n") <= MAX_DEFINITIONS:
        return None
    for number, match in enumerate(_DEFINITION_LINE.finditer(text), 1):
        if number > MAX_DEFINITIONS:
            return match.start()
    return None

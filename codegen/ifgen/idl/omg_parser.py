"""From the text of an .idl file to its tree, in time linear in the text, whatever that holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, Final, Protocol, cast

from lark.exceptions import UnexpectedInput

from ifgen.diagnostics import MAX_PROBLEMS, Diagnostic, Source
from ifgen.idl import omg_explain, omg_recovery
from ifgen.idl.omg_tree import (
    AnnotationNode,
    BasicNode,
    ConstantDclNode,
    DeclaratorNode,
    EnumNode,
    FixedNode,
    IdlNode,
    IdlTree,
    IncludeNode,
    MemberNode,
    ModuleNode,
    ParameterNode,
    PathNode,
    SequenceNode,
    StringNode,
    StructNode,
    TypedefNode,
    ValueKind,
    ValueNode,
)
from ifgen.idl.tables import parse_function

_VALUE_KINDS: Final[dict[str, ValueKind]] = {
    "INTEGER": "integer",
    "REAL": "real",
    "FIXED_POINT": "fixed",
    "CHARACTER": "character",
    "TRUE": "boolean",
    "FALSE": "boolean",
    "TEXT": "text",
    "WIDE_TEXT": "wide text",
}


class _Token(Protocol):
    """The part of lark's tokens that we use, the same in lark 1.x and lark-parser 0.12."""

    type: str
    value: str
    start_pos: int


def _end(token: _Token) -> int:
    return token.start_pos + len(token.value)


class _TreeBuilder:
    """Called by lark while it parses, so that no tree of lark's own is ever built."""

    def specification(self, definitions: list[IdlNode | None]) -> list[IdlNode]:
        return [definition for definition in definitions if definition is not None]

    def module(self, children: list[Any]) -> ModuleNode:
        annotations, (name, *definitions) = _divided(children)
        nodes = [node for node in definitions if node is not None]
        return ModuleNode(annotations, name.value, name.start_pos, nodes)

    def struct(self, children: list[Any]) -> StructNode:
        annotations, (name, *members) = _divided(children)
        return StructNode(annotations, name.value, name.start_pos, members)

    def forward(self, _: list[_Token]) -> None:
        return None

    def constant(self, children: list[Any]) -> ConstantDclNode:
        annotations, (type_, name, value) = _divided(children)
        return ConstantDclNode(annotations, type_, name.value, name.start_pos, value)

    def typedef(self, children: list[Any]) -> TypedefNode:
        return TypedefNode(*children)

    def enum(self, children: list[Any]) -> EnumNode:
        _, (name, *_) = _divided(children)
        return EnumNode(name.value, name.start_pos)

    def enumerator(self, _: list[Any]) -> None:
        return None

    def include(self, tokens: list[_Token]) -> IncludeNode:
        (token,) = tokens
        path = token.value.removeprefix("#include").lstrip()
        return IncludeNode(path[1:-1], token.start_pos, _end(token))

    def member(self, children: list[Any]) -> MemberNode:
        annotations, (type_, *declarators) = _divided(children)
        return MemberNode(annotations, type_, declarators)

    def declarator(self, children: list[Any]) -> DeclaratorNode:
        name, *sizes = children
        return DeclaratorNode(name.value, name.start_pos, sizes)

    def annotation(self, children: list[Any]) -> AnnotationNode:
        at, label, *values = children
        value = values[0] if values and isinstance(values[0], ValueNode) else None
        parameters = values if value is None else ()
        return AnnotationNode(label.parts[0], value, parameters, at.start_pos, label.end)

    def parameter(self, children: list[Any]) -> ParameterNode:
        name, value = children
        return ParameterNode(name.value, value)

    def basic(self, tokens: list[_Token]) -> BasicNode:
        words = " ".join([token.value for token in tokens])
        return BasicNode(words, tokens[0].start_pos, _end(tokens[-1]))

    def sequence(self, children: list[Any]) -> SequenceNode:
        opening, element, *bound, closing = children
        return SequenceNode(element, bound[0] if bound else None, opening.start_pos, _end(closing))

    def string(self, children: list[Any]) -> StringNode:
        keyword, *rest = children
        bound, end = (rest[0], _end(rest[1])) if rest else (None, _end(keyword))
        return StringNode(keyword.value == "wstring", bound, keyword.start_pos, end)

    def fixed(self, children: list[Any]) -> FixedNode:
        return FixedNode(children[0].start_pos, _end(children[-1]))

    def value(self, children: list[Any]) -> ValueNode:
        sign = ""
        first = children[0]
        start = first.start if isinstance(first, PathNode) else first.start_pos
        if not isinstance(first, PathNode) and first.type == "SIGN":
            sign = children.pop(0).value
        if isinstance(children[0], PathNode):
            (path,) = children
            return ValueNode("name", (path.text,), sign, start, path.end)
        kind = _VALUE_KINDS[children[0].type]
        return ValueNode(kind, [token.value for token in children], sign, start, _end(children[-1]))

    def path(self, children: list[Any]) -> PathNode:
        first, *rest = children
        if isinstance(first, PathNode):
            first.parts.append(rest[1].value)
            return first._replace(end=_end(rest[1]))
        name = rest[0] if rest else first
        return PathNode([name.value], bool(rest), first.start_pos, _end(name))

    label = path


def _divided(children: list[Any]) -> tuple[Sequence[AnnotationNode], list[Any]]:
    """The annotations that something begins with, and the rest."""
    count = next(index for index, child in enumerate(children) if not isinstance(child, AnnotationNode))
    return children[:count], children[count:]


@lru_cache(maxsize=1)
def _parser() -> Callable[[str], list[IdlNode]]:
    return cast("Callable[[str], list[IdlNode]]", parse_function("omg_idl", "specification", _TreeBuilder()))


def parse_idl(source: Source) -> IdlTree:
    """The tree of an .idl file. A definition or member with wrong syntax is reported and left out.

    Each attempt reads the rest of the file again. No definition is left after `MAX_PROBLEMS` attempts, or if
    something stays open up to the end.
    """
    text = source.text
    problems: list[Diagnostic] = []
    while len(problems) < MAX_PROBLEMS:
        try:
            return IdlTree(source, _parser()(text), tuple(problems))
        except UnexpectedInput as error:
            expected: set[str] = set(
                getattr(error, "expected", None) or getattr(error, "allowed", None) or ()
            )
            token = getattr(error, "token", None)
            at_end = token is not None and token.type == "$END"
            if at_end and problems:
                break  # it follows from what was left out
            position = len(source.text) if at_end else error.pos_in_stream or 0
            problems.append(omg_explain.syntax(source, position, expected))
            rest = None if at_end else omg_recovery.without(text, position, expected)
            if rest is None:
                break
            text = rest
    return IdlTree(source, [], tuple(problems))

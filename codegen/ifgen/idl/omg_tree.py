"""The syntax tree of an .idl file. Places are character offsets into the source."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal, NamedTuple, TypeAlias

from ifgen.diagnostics import Diagnostic, Source

ValueKind: TypeAlias = Literal[
    "integer", "real", "fixed", "boolean", "character", "text", "wide text", "name"
]


class ValueNode(NamedTuple):
    """A literal or a name, as written; `parts` are the literals of a text, which are put together."""

    kind: ValueKind
    parts: Sequence[str]
    sign: str
    start: int
    end: int


class PathNode(NamedTuple):
    """`a::b::c`; `absolute` where it begins with `::`."""

    parts: list[str]
    absolute: bool
    start: int
    end: int

    @property
    def text(self) -> str:
        """The path in its usual form."""
        return "::" * self.absolute + "::".join(self.parts)


class ParameterNode(NamedTuple):
    """`name=value` in an annotation."""

    name: str
    value: ValueNode


class AnnotationNode(NamedTuple):
    """`@name`, `@name(value)` or `@name(name=value, ...)`."""

    name: str
    value: ValueNode | None
    parameters: Sequence[ParameterNode]
    start: int
    end: int


class BasicNode(NamedTuple):
    """A basic type, in the words of the file: `unsigned long`."""

    words: str
    start: int
    end: int


class StringNode(NamedTuple):
    """`string<bound>` or `wstring<bound>`; the bound is optional."""

    wide: bool
    bound: ValueNode | None
    start: int
    end: int


class FixedNode(NamedTuple):
    """`fixed<digits, scale>`, which nothing supports."""

    start: int
    end: int


class SequenceNode(NamedTuple):
    """`sequence<element, bound>`; the bound is optional."""

    element: TypeNode
    bound: ValueNode | None
    start: int
    end: int


TypeNode: TypeAlias = BasicNode | PathNode | StringNode | SequenceNode | FixedNode


class DeclaratorNode(NamedTuple):
    """`name` or `name[size]`, perhaps with more sizes."""

    name: str
    start: int
    sizes: Sequence[ValueNode]


class MemberNode(NamedTuple):
    """`@annotation TYPE name, name[size];`."""

    annotations: Sequence[AnnotationNode]
    type: TypeNode
    declarators: Sequence[DeclaratorNode]


class StructNode(NamedTuple):
    """`struct name { members };`; `start` is where the name starts, here and below."""

    annotations: Sequence[AnnotationNode]
    name: str
    start: int
    members: Sequence[MemberNode]


class ConstantDclNode(NamedTuple):
    """`const TYPE name = value;`."""

    annotations: Sequence[AnnotationNode]
    type: TypeNode
    name: str
    start: int
    value: ValueNode


class TypedefNode(NamedTuple):
    """`typedef TYPE name[size];`; the size is optional."""

    type: TypeNode
    declarator: DeclaratorNode


class EnumNode(NamedTuple):
    """`enum name { ... };`, whose values do not matter."""

    name: str
    start: int


class IncludeNode(NamedTuple):
    """`#include "path"` or `#include <path>`."""

    path: str
    start: int
    end: int


class ModuleNode(NamedTuple):
    """`module name { definitions };`."""

    annotations: Sequence[AnnotationNode]
    name: str
    start: int
    definitions: Sequence[IdlNode]


IdlNode: TypeAlias = ModuleNode | StructNode | ConstantDclNode | TypedefNode | EnumNode | IncludeNode


class IdlTree(NamedTuple):
    """The definitions of a file, without those of which `problems` say that their syntax is wrong."""

    source: Source
    definitions: Sequence[IdlNode]
    problems: tuple[Diagnostic, ...] = ()


NOTHING: Final[Sequence[IdlNode]] = ()

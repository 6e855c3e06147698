"""The types of members, from the words of an .idl file, as rosidl_parser resolves them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from ifgen.definition.impossible import check_sizes
from ifgen.definition.omg_idl import mistakes
from ifgen.definition.omg_idl.values import size_of
from ifgen.definition.problems import FileProblems
from ifgen.definition.types import (
    Array,
    BasicType,
    BasicTypeName,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    FieldType,
    NamespacedType,
    StringType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
    ValueType,
)
from ifgen.diagnostics import Source, Span
from ifgen.idl.omg_tree import (
    BasicNode,
    DeclaratorNode,
    EnumNode,
    FixedNode,
    PathNode,
    SequenceNode,
    StringNode,
    TypedefNode,
    TypeNode,
    ValueNode,
)

BASIC_TYPES: Final[Mapping[str, BasicTypeName]] = {
    "short": "int16",
    "long": "int32",
    "long long": "int64",
    "unsigned short": "uint16",
    "unsigned long": "uint32",
    "unsigned long long": "uint64",
    "int8": "int8",
    "int16": "int16",
    "int32": "int32",
    "int64": "int64",
    "uint8": "uint8",
    "uint16": "uint16",
    "uint32": "uint32",
    "uint64": "uint64",
    "float": "float",
    "double": "double",
    "char": "char",
    "boolean": "boolean",
    "octet": "octet",
}
"""The basic types that can be sent, and what rosidl calls them; `wchar` and `long double` are missing."""


@dataclass(frozen=True, slots=True)
class _Named:
    """A name that must be a typedef."""

    node: PathNode


_Element: TypeAlias = ValueType | _Named


@dataclass(frozen=True, slots=True)
class _Collection:
    """An array of `size` elements, or a sequence of at most `maximum`; the element may be a name."""

    element: _Element
    size: int | None = None
    maximum: int | None = None

    def of(self, element: ValueType) -> FieldType:
        """The type, now that its element is known."""
        if self.size is not None:
            return Array(element, self.size)
        return UnboundedSequence(element) if self.maximum is None else BoundedSequence(element, self.maximum)


_Meaning: TypeAlias = _Element | _Collection


class Types:
    """The types of one file; what is wrong goes to `problems`, and the result is None."""

    def __init__(
        self,
        source: Source,
        typedefs: Iterable[TypedefNode],
        enums: Iterable[EnumNode],
        package: str,
        problems: FileProblems,
    ) -> None:
        self._source = source
        self._problems = problems
        self._enums = {enum.name: enum for enum in enums}
        self._package = package
        self._typedefs: dict[str, tuple[TypedefNode, _Meaning | None]] = {}
        for node in typedefs:
            self._define(node)

    def member(self, type_: TypeNode, declarator: DeclaratorNode) -> FieldType | None:
        """The type of a member, which `declarator` may turn into an array."""
        written = self._with_sizes(self._written(type_), type_, declarator)
        return None if written is None else self._resolved(written, type_)

    def constant(self, type_: TypeNode) -> BasicType | StringType | None:
        """The type of a constant. The bound of a string does not count: rosidl puts its length there."""
        match type_:
            case BasicNode():
                return self._basic(type_)
            case StringNode(wide=wide):
                return UnboundedWString() if wide else UnboundedString()
            case _:
                self._problems.error(mistakes.constant_type, self._source, type_)
                return None

    def _define(self, node: TypedefNode) -> None:
        name = node.declarator.name
        meaning = self._with_sizes(self._written(node.type), node.type, node.declarator)
        first = self._typedefs.setdefault(name, (node, meaning))
        if not _same(first[1], meaning):
            span = self._span(node.declarator.start, name)
            before = self._span(first[0].declarator.start, name)
            self._problems.error(mistakes.typedef_again, name, span, before)

    def _span(self, start: int, text: str) -> Span:
        return Span(self._source, start, start + len(text))

    def _written(self, node: TypeNode) -> _Meaning | None:
        """The type as written, before names are looked up."""
        match node:
            case BasicNode():
                return self._basic(node)
            case PathNode():
                return self._path(node)
            case StringNode():
                return self._string(node)
            case SequenceNode():
                return self._sequence(node)
            case FixedNode():
                self._problems.error(mistakes.no_fixed, self._source, node)
                return None

    def _basic(self, node: BasicNode) -> BasicType | None:
        name = BASIC_TYPES.get(node.words)
        if name is None:
            self._problems.error(mistakes.no_basic_type, self._source, node)
            return None
        return BasicType(name)

    def _path(self, node: PathNode) -> _Element | None:
        if len(node.parts) == 1 and not node.absolute:
            return _Named(node)
        if len(node.parts) != 3 or node.parts[1] not in ("msg", "srv", "action"):
            self._problems.error(mistakes.wrong_path, self._source, node)
            return None
        package, folder, name = node.parts
        if package == self._package and name in self._enums:
            self._problems.error(mistakes.is_enum, self._source, node, self._enums[name])
            return None
        if folder != "msg" and name.endswith(("_Event", "_FeedbackMessage")):
            self._problems.error(mistakes.derived_type, self._source, node)
            return None
        return NamespacedType(package, folder, name)

    def _string(self, node: StringNode) -> StringType | None:
        if node.bound is None:
            return UnboundedWString() if node.wide else UnboundedString()
        bound = self._size(node.bound)
        if bound is None:
            return None
        return BoundedWString(bound) if node.wide else BoundedString(bound)

    def _sequence(self, node: SequenceNode) -> _Collection | None:
        element = None if isinstance(node.element, SequenceNode) else self._written(node.element)
        maximum = None if node.bound is None else self._size(node.bound)
        if isinstance(node.element, SequenceNode) or isinstance(element, _Collection):
            self._problems.error(mistakes.nested_collection, self._source, node)
            return None
        if element is None or (node.bound is not None and maximum is None):
            return None
        if maximum is None and isinstance(element, BoundedWString):
            # rosidl_parser applies the bound of a wstring to a sequence without one; so does the hash.
            maximum = element.maximum_size
            span = Span(self._source, node.start, node.end)
            self._problems.warning(mistakes.wstring_sequence, span, maximum)
        return _Collection(element, maximum=maximum)

    def _with_sizes(
        self, written: _Meaning | None, node: TypeNode, declarator: DeclaratorNode
    ) -> _Meaning | None:
        sizes = [self._size(size) for size in declarator.sizes]
        if written is None or not sizes:
            return written
        if len(sizes) > 1 or isinstance(written, _Collection):
            self._problems.error(mistakes.nested_collection, self._source, node, declarator)
            return None
        return None if sizes[0] is None else _Collection(written, size=sizes[0])

    def _size(self, node: ValueNode) -> int | None:
        size = size_of(node)
        if size is None:
            self._problems.error(mistakes.wrong_size, self._source, node)
        return size

    def _resolved(self, written: _Meaning, node: TypeNode) -> FieldType | None:
        """Look up names as rosidl_parser does: one of the member, and one in what a typedef says of it."""
        outer = written if isinstance(written, _Collection) else None
        meaning: _Meaning | None = written if outer is None else outer.element
        if isinstance(meaning, _Named):
            meaning = self._meaning(meaning)
            if isinstance(meaning, _Collection) and outer is None:
                outer, meaning = meaning, meaning.element
                if isinstance(meaning, _Named):
                    meaning = self._meaning(meaning)
        if isinstance(meaning, _Collection):
            self._problems.error(mistakes.nested_collection, self._source, node)
            return None
        if isinstance(meaning, _Named):
            self._problems.error(mistakes.typedef_of_typedef, self._source, node, meaning.node)
            return None
        if meaning is None:
            return None
        type_ = meaning if outer is None else outer.of(meaning)
        check_sizes(type_, Span(self._source, node.start, node.end), self._problems)
        return type_

    def _meaning(self, named: _Named) -> _Meaning | None:
        name = named.node.text
        if name in self._typedefs:
            return self._typedefs[name][1]
        self._problems.error(
            mistakes.unknown_name, self._source, named.node, self._typedefs, self._enums, self._package
        )
        return None


def _same(one: _Meaning | None, other: _Meaning | None) -> bool:
    """Whether two meanings are the same, wherever their names stand."""
    if isinstance(one, _Collection) and isinstance(other, _Collection):
        return (one.size, one.maximum) == (other.size, other.maximum) and _same(one.element, other.element)
    if isinstance(one, _Named) and isinstance(other, _Named):
        return one.node.text == other.node.text
    return one == other

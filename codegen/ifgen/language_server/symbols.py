"""The type, field or constant at a place, and the places of all of them in a file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from ifgen.definition.interfaces import Interface, Message
from ifgen.definition.references import references, type_span
from ifgen.definition.spelling import field_type
from ifgen.definition.types import COLLECTIONS, NamespacedType
from ifgen.diagnostics import Source, Span
from ifgen.idl import parser
from ifgen.idl.tree import DefinitionNode, FieldNode, InterfaceTree
from ifgen.language_server.workspace import Workspace, members_of, parts_of, uses_in_document
from ifgen.reading.package_files import node_name

Kind = Literal["type", "field", "constant", "package"]

_PARSERS: Final = {
    ".msg": parser.parse_message,
    ".srv": parser.parse_service,
    ".action": parser.parse_action,
}
_PARTS: Final = {
    ".msg": ("",),
    ".srv": ("_Request", "_Response"),
    ".action": ("_Goal", "_Result", "_Feedback"),
}


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name in a file. `type_name` is the type that is named, or that has the member.

    A package is named by the first part of a type.
    """

    kind: Kind
    type_name: str
    span: Span
    member: str = ""


def tree_of(source: Source) -> InterfaceTree | None:
    """The tree of a .msg, .srv or .action file, whatever is wrong in it; None for other files."""
    parse = _PARSERS.get(source.path.suffix)
    return parse(source) if parse is not None else None


def symbol_at(workspace: Workspace, source: Source, offset: int) -> Symbol | None:
    """The symbol at a place of a file."""
    for symbol in symbols(workspace, source):
        if symbol.span.start <= offset <= symbol.span.end:
            return symbol
    return None


def named_at(workspace: Workspace, source: Source, offset: int) -> Symbol | None:
    """The symbol whose name is at a place: of `package/Type` either of the two."""
    symbol = symbol_at(workspace, source, offset)
    if symbol is None or symbol.kind != "type":
        return symbol
    word = source.text[symbol.span.start : symbol.span.end]
    package = symbol.type_name.partition("/")[0]
    first = symbol.span.start + len(package)
    if word.startswith((f"{package}/", f"{package}::")) and offset <= first:
        return Symbol("package", symbol.type_name, Span(source, symbol.span.start, first))
    name = symbol.type_name.rpartition("/")[2]
    return Symbol("type", symbol.type_name, Span(source, symbol.span.end - len(name), symbol.span.end))


def symbols(workspace: Workspace, source: Source) -> Iterator[Symbol]:
    """All symbols in a file, in its order."""
    package = workspace.package_of(source.path)
    if node_name(source.path.name) is not None:
        for use in uses_in_document(source, workspace.search()):
            yield Symbol("type", use.type_name, use.span)
        return
    tree = tree_of(source)
    name = package.name if package is not None else source.path.parent.parent.name
    if tree is None:
        yield from _of_idl(workspace, source)
        return
    for part, end in zip(tree.parts, _PARTS[source.path.suffix], strict=True):
        owner = f"{name}/{source.path.suffix[1:]}/{source.path.stem}{end}"
        for node in part.definitions:
            yield from _of_node(source, node, name, owner)


def owner_file(workspace: Workspace, type_name: str) -> Source | None:
    """The file that defines a type, or a part of a service or an action."""
    interface = interface_of(workspace, type_name)
    return interface.source if interface is not None else None


def interface_of(workspace: Workspace, type_name: str) -> Interface | None:
    """The interface of this name, or the one that has a part of this name."""
    found = workspace.interface(type_name)
    whole, part, _ = type_name.rpartition("_")
    if found is None and part and whole.count("/") == 2:
        found = workspace.interface(whole)
    return found[0] if found is not None else None


def member_span(workspace: Workspace, symbol: Symbol) -> Span | None:
    """The place where a field or constant is defined."""
    interface = interface_of(workspace, symbol.type_name)
    if interface is None:
        return None
    for part in parts_of(interface):
        if part.type_name == symbol.type_name:
            return next((each.span for each in members_of(part) if each.name == symbol.member), None)
    return None


def definition_of(workspace: Workspace, symbol: Symbol) -> Span | None:
    """The place that an editor goes to."""
    if symbol.kind != "type":
        return member_span(workspace, symbol)
    source = owner_file(workspace, symbol.type_name)
    if source is None:
        return None
    interface = interface_of(workspace, symbol.type_name)
    assert interface is not None
    return interface.span or Span(source, 0, 0)


def _of_node(source: Source, node: DefinitionNode, package: str, owner: str) -> Iterator[Symbol]:
    type_ = field_type(node.type_text, package)
    if isinstance(type_, COLLECTIONS):
        type_ = type_.value_type
    if isinstance(type_, NamespacedType):
        end = node.type_start + len(node.type_text.partition("[")[0])
        yield Symbol("type", type_.type_name, Span(source, node.type_start, end))
    kind: Kind = "field" if isinstance(node, FieldNode) else "constant"
    yield Symbol(kind, owner, Span(source, node.name_start, node.name_start + len(node.name)), node.name)


def _of_idl(workspace: Workspace, source: Source) -> Iterator[Symbol]:
    """The symbols of an .idl file, or none while it cannot be read."""
    for message in messages_in(workspace, source.path):
        for field, type_ in references(message):
            span = type_span(field)
            if span is not None:
                yield Symbol("type", type_.type_name, span)
        for field in message.fields:
            if field.span is not None:
                yield Symbol("field", message.type_name, field.span, field.name)
        for constant in message.constants:
            if constant.span is not None:
                yield Symbol("constant", message.type_name, constant.span, constant.name)


def messages_in(workspace: Workspace, path: Path) -> Iterator[Message]:
    """The messages that a file defines."""
    for package in workspace.registry().packages.values():
        for interface in package.interfaces:
            if interface.source is not None and interface.source.path.absolute() == path:
                yield from parts_of(interface)

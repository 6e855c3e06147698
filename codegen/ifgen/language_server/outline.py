"""Everything beside the text of a file in an editor: its outline, folds, kinds of words, and hints."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from lsprotocol.types import (
    DocumentSymbol,
    FoldingRange,
    FoldingRangeKind,
    InlayHint,
    SymbolKind,
)

from ifgen.definition.interfaces import Constant, Field, Interface, Message
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.diagnostics import Source
from ifgen.idl.tree import ConstantNode, DefinitionNode
from ifgen.language_server.hover import layout
from ifgen.language_server.positions import Positions
from ifgen.language_server.symbols import messages_in, symbols, tree_of
from ifgen.language_server.workspace import Workspace, members_of

TOKEN_TYPES: Final = ("type", "property", "enumMember")
"""The kinds of words, in the order of their numbers."""

_PARTS: Final = {
    1: ("",),
    2: ("request", "response"),
    3: ("goal", "result", "feedback"),
}


def document_symbols(workspace: Workspace, source: Source, positions: Positions) -> list[DocumentSymbol]:
    """Fields and constants, below the parts of a service or an action."""
    tree = tree_of(source)
    if tree is None:
        return [_message_symbol(message, positions) for message in messages_in(workspace, source.path)]
    parts = [[_node_symbol(node, positions) for node in part.definitions] for part in tree.parts]
    if len(parts) == 1:
        return parts[0]
    found: list[DocumentSymbol] = []
    for name, part, members in zip(_PARTS[len(parts)], tree.parts, parts, strict=True):
        start = part.definitions[0].type_start if part.definitions else 0
        last = part.definitions[-1] if part.definitions else None
        end = _end_of(last) if last is not None else start
        place = positions.range(start, end)
        found.append(DocumentSymbol(name, SymbolKind.Struct, place, place, children=members))
    return found


def folding_ranges(positions: Positions) -> list[FoldingRange]:
    """Comments of several lines, and the parts of a service or an action."""
    found: list[FoldingRange] = []
    comment: int | None = None
    part = 0
    lines = [positions.line(number).strip() for number in range(positions.lines)]
    while lines and not lines[-1]:
        lines.pop()
    for number, line in enumerate([*lines, "---"]):
        if line.startswith("#"):
            comment = number if comment is None else comment
            continue
        if comment is not None and number - 1 > comment:
            found.append(FoldingRange(comment, number - 1, kind=FoldingRangeKind.Comment))
        comment = None
        if line == "---":
            if number - 1 > part and "---" in lines:
                found.append(FoldingRange(part, number - 1, kind=FoldingRangeKind.Region))
            part = number + 1
    return found


def semantic_tokens(workspace: Workspace, source: Source, positions: Positions) -> list[int]:
    """The words of a file with their kinds, each relative to the one before."""
    data: list[int] = []
    line = character = 0
    kinds = {"type": 0, "field": 1, "constant": 2}
    for symbol in sorted(symbols(workspace, source), key=lambda each: each.span.start):
        place = positions.range(symbol.span.start, symbol.span.end)
        start = place.start
        same = start.line == line
        length = place.end.character - start.character
        data += (start.line - line, start.character - character if same else start.character, length)
        data += (kinds[symbol.kind], 0)
        line, character = start.line, start.character
    return data


def inlay_hints(
    workspace: Workspace, source: Source, positions: Positions, first: int, last: int
) -> list[InlayHint]:
    """The bytes of each field on the wire, as far as these are the same in all messages."""
    found: list[InlayHint] = []
    registry = workspace.registry()
    for message in messages_in(workspace, source.path):
        places, _ = layout(message, registry)
        for field in message.fields:
            place = places.get(field.name)
            if place is None or field.span is None or not first <= field.span.line - 1 <= last:
                continue
            label = f"@{place.offset} +{place.size}"
            tooltip = f"{place.size} bytes at offset {place.offset} on the wire"
            position = positions.position(field.span.end)
            found.append(InlayHint(position, label, tooltip=tooltip, padding_left=True))
    return found


def all_names(workspace: Workspace) -> Iterator[tuple[Interface, str, Field | Constant | None]]:
    """The types of the workspace and their members, each with its name."""
    requested = set(workspace.registry().requested)
    for package in workspace.registry().packages.values():
        if package.name in requested:
            for interface in package.interfaces:
                yield interface, interface.name, None
                if isinstance(interface, Message):
                    for member in members_of(interface):
                        yield interface, member.name, member


def _node_symbol(node: DefinitionNode, positions: Positions) -> DocumentSymbol:
    kind = SymbolKind.Constant if isinstance(node, ConstantNode) else SymbolKind.Field
    detail = f"{node.type_text} = {node.value}" if isinstance(node, ConstantNode) else node.type_text
    whole = positions.range(node.type_start, _end_of(node))
    name = positions.range(node.name_start, node.name_start + len(node.name))
    return DocumentSymbol(node.name, kind, whole, name, detail=detail)


def _message_symbol(message: Message, positions: Positions) -> DocumentSymbol:
    """The outline of a message in an .idl file."""
    children: list[DocumentSymbol] = []
    for member in members_of(message):
        if member.span is None:
            continue
        place = positions.range(member.span.start, member.span.end)
        detail = spelled(member.type, message.package)
        if isinstance(member, Constant):
            children.append(
                DocumentSymbol(
                    member.name,
                    SymbolKind.Constant,
                    place,
                    place,
                    detail=f"{detail} = {spelled_value(member.value)}",
                )
            )
        else:
            children.append(DocumentSymbol(member.name, SymbolKind.Field, place, place, detail=detail))
    own = positions.range(message.span.start, message.span.end) if message.span else positions.range(0, 0)
    ends = [child.range.end for child in children] or [own.end]
    whole = type(own)(own.start, max(ends, key=lambda end: (end.line, end.character)))
    return DocumentSymbol(message.name, SymbolKind.Struct, whole, own, children=children)


def _end_of(node: DefinitionNode) -> int:
    if node.value is None:
        return node.name_start + len(node.name)
    return node.value_start + len(node.value)

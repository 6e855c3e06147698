"""Definitions as `interface show` prints them: as their files have them, each field's message below it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple, TypeAlias

from ifgen.definition.interfaces import Action, Constant, Field, Interface, Message, Registry, Service
from ifgen.definition.meaning.reading import reading_of
from ifgen.definition.meaning.values import bracketed
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.definition.type_description import Described
from ifgen.definition.types import Array, BoundedSequence, NamespacedType, UnboundedSequence
from ifgen.diagnostics import Source
from ifgen.idl import parser
from ifgen.idl.tree import DefinitionNode
from ifgen.reading.packages import IDL

_SEPARATOR = "---"
_PARSERS = {"msg": parser.parse_message, "srv": parser.parse_service, "action": parser.parse_action}


Comments: TypeAlias = Literal["all", "own", "none"]
"""Which comments to show, with blank lines: all, those of the interface that was asked for, or none."""


def shown(described: Described, registry: Registry, comments: Comments) -> Iterator[str]:
    """The lines, those of nested messages with a tab for each level."""
    yield from _level(described, registry, comments, "")


def _level(described: Described, registry: Registry, comments: Comments, indent: str) -> Iterator[str]:
    below: Comments = "all" if comments == "all" else "none"
    for line in lines_of(described, registry):
        text = line.code if comments == "none" else line.text
        if text:
            yield indent + text
        elif comments != "none":
            yield ""
        if line.nested is not None:
            yield from _level(line.nested, registry, below, indent + "\t")


class Line(NamedTuple):
    """A line of a definition.

    `code` is the line without its comment: empty for a blank line and for one that is all comment. `nested`
    is the message that a field consists of, if it does.
    """

    text: str
    code: str
    nested: Message | None = None


def lines_of(described: Described, registry: Registry) -> Iterator[Line]:
    """The lines of an interface.

    The file of a message, service or action is taken as it is written. A derived type has no file, and an
    .idl file has another notation: their lines are written in the notation of .msg files.
    """
    interface = registry.get(described.type_name)
    source = interface.source if interface else None
    if interface is None or source is None or source.path.suffix == IDL:
        yield from _written(described, registry)
    else:
        yield from _as_in_file(interface, source, registry)


def _as_in_file(interface: Interface, source: Source, registry: Registry) -> Iterator[Line]:
    tree = _PARSERS[interface.folder](source)
    found: dict[int, tuple[int, Message | None]] = {}
    for part, node_part in zip(_parts(interface), tree.parts, strict=True):
        fields = {field.name: field for field in part.fields}
        for node in node_part.definitions:
            number, column = source.position(node.type_start)
            field = fields.get(node.name)
            nested = _nested(field, registry) if field else None
            found[number] = (column - 1 + _end(node) - node.type_start, nested)
    for number, line in enumerate(source.text.splitlines(), 1):
        text = line.rstrip()
        if number in found:
            end, nested = found[number]
            yield Line(text, text[:end].strip(), nested)
        else:
            yield Line(text, text.partition("#")[0].strip())


def _end(node: DefinitionNode) -> int:
    """The offset where a definition ends and its comment may begin."""
    if node.value is None:
        return node.name_start + len(node.name)
    return node.value_start + len(node.value)


def _written(described: Described, registry: Registry) -> Iterator[Line]:
    for index, part in enumerate(_parts(described)):
        if index:
            yield Line(_SEPARATOR, _SEPARATOR)
        yield from _comment(part.documentation)
        for constant in part.constants:
            code = f"{spelled(constant.type, part.package)} {constant.name}={spelled_value(constant.value)}"
            yield from _with_comment(Line(code, code), constant)
        for field in part.fields:
            default = "" if field.default_value is None else f" {spelled_value(field.default_value)}"
            code = f"{spelled(field.type, part.package)} {field.name}{default}"
            yield from _with_comment(Line(code, code, _nested(field, registry)), field)


def _with_comment(line: Line, described: Field | Constant) -> Iterator[Line]:
    found = reading_of(described)
    comment = f"{found.text} {bracketed(found.meaning)}".strip()
    if "\n" in comment:
        yield from _comment(comment)
        yield line
    else:
        yield line._replace(text=f"{line.code} # {comment}") if comment else line


def _comment(documentation: str) -> Iterator[Line]:
    for line in documentation.splitlines():
        yield Line(f"# {line}".rstrip(), "")


def _parts(described: Described) -> tuple[Message, ...]:
    match described:
        case Message():
            return (described,)
        case Service():
            return (described.request, described.response)
        case Action():
            return (described.goal, described.result, described.feedback)


def _nested(field: Field, registry: Registry) -> Message | None:
    value_type = field.type
    if isinstance(value_type, Array | BoundedSequence | UnboundedSequence):
        value_type = value_type.value_type
    return registry.message(value_type.type_name) if isinstance(value_type, NamespacedType) else None

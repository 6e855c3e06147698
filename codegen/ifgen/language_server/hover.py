"""Hover texts: the definition of a name, its size on the wire, who uses it; and the place of each field."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from ifgen.definition.interfaces import Constant, Field, Interface, Message, Registry
from ifgen.definition.spelling import spelled, spelled_value
from ifgen.definition.type_description import type_hash
from ifgen.definition.types import Array, BasicType, FieldType, NamespacedType
from ifgen.language_server.symbols import Symbol, interface_of
from ifgen.language_server.workspace import Workspace, members_of, parts_of
from ifgen.wire.program import NUMBERS

_EMPTY_MESSAGE: Final = 1
"""Bytes of a message without fields: IDL has no empty structs."""


@dataclass(frozen=True, slots=True)
class Place:
    """The bytes of a field on the wire, counted from behind the header of 4 bytes."""

    offset: int
    size: int


def layout(message: Message, registry: Registry) -> tuple[dict[str, Place], int | None]:
    """The places of the first fields, up to one of variable size, and the size of all if that is constant."""
    places: dict[str, Place] = {}
    end = 0
    for field in message.fields:
        found = _after(field.type, end, registry)
        if found is None:
            return places, None
        start, end = found
        places[field.name] = Place(start, end - start)
    return places, end or _EMPTY_MESSAGE


def _after(type_: FieldType, position: int, registry: Registry) -> tuple[int, int] | None:
    """Where a value starts and ends on the wire; None if that depends on the value."""
    if isinstance(type_, BasicType):
        size = NUMBERS[type_.typename].size
        start = -(-position // size) * size
        return start, start + size
    if isinstance(type_, NamespacedType):
        nested = registry.get(type_.type_name)
        if not isinstance(nested, Message):
            return None  # it is not there, or no message
        end = position
        first: int | None = None
        for field in nested.fields:
            found = _after(field.type, end, registry)
            if found is None:
                return None
            start, end = found
            first = start if first is None else first
        return (position, position + _EMPTY_MESSAGE) if first is None else (first, end)
    if isinstance(type_, Array) and isinstance(type_.value_type, BasicType):
        size = NUMBERS[type_.value_type.typename].size
        start = -(-position // size) * size
        return start, start + size * type_.size
    if isinstance(type_, Array):
        first, end = None, position
        for _ in range(type_.size):
            found = _after(type_.value_type, end, registry)
            if found is None:
                return None
            first = found[0] if first is None else first
            end = found[1]
        assert first is not None
        return first, end
    return None


def hover(workspace: Workspace, symbol: Symbol) -> str | None:
    """Markdown about a symbol; None if nothing is known."""
    interface = interface_of(workspace, symbol.type_name)
    if interface is None:
        return None
    found = workspace.interface(interface.type_name)
    assert found is not None
    registry = found[1]
    if symbol.kind == "type":
        return "\n\n".join(_about_type(workspace, interface, registry))
    part = next((part for part in parts_of(interface) if part.type_name == symbol.type_name), None)
    for member in members_of(part) if part is not None else ():
        if member.name == symbol.member:
            assert part is not None
            return "\n\n".join(_about_member(part, member, registry))
    return None


def _about_type(workspace: Workspace, interface: Interface, registry: Registry) -> Iterator[str]:
    kind = {"msg": "message", "srv": "service", "action": "action"}[interface.folder]
    yield f"**{interface.type_name}** ({kind})"
    if interface.documentation:
        yield interface.documentation
    parts = ["\n".join(_lines(part)) for part in parts_of(interface)]
    definition = "\n---\n".join(parts)
    yield f"```rosmsg\n{definition}\n```"
    facts: list[str] = []
    if isinstance(interface, Message):
        size = layout(interface, registry)[1]
        facts.append("variable size" if size is None else f"{size} bytes on the wire")
    users = {use.span.source.path for use in workspace.uses(interface.type_name)}
    facts.append(f"used in {len(users)} {'file' if len(users) == 1 else 'files'}")
    yield ", ".join(facts)
    if workspace.is_whole(interface):
        yield f"`{type_hash(interface, registry)}`"


def _about_member(part: Message, member: Field | Constant, registry: Registry) -> Iterator[str]:
    yield f"```rosmsg\n{_line(part, member)}\n```"
    if member.documentation:
        yield member.documentation
    if member.unit:
        yield f"in {member.unit}"
    place = layout(part, registry)[0].get(member.name)
    if place is not None and isinstance(member, Field):
        yield f"{place.size} bytes at offset {place.offset} of {part.type_name}"


def _lines(message: Message) -> Iterator[str]:
    for member in members_of(message):
        unit = f"  # [{member.unit}]" if member.unit else ""
        yield _line(message, member) + unit


def _line(message: Message, member: Field | Constant) -> str:
    head = f"{spelled(member.type, message.package)} {member.name}"
    if isinstance(member, Constant):
        return f"{head} = {spelled_value(member.value)}"
    return head if member.default_value is None else f"{head} {spelled_value(member.default_value)}"

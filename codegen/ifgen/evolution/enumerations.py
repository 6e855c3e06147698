"""The enumerations that classes make of constants: members that are lost while their constants stay."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ifgen.definition.interfaces import Constant, Message
from ifgen.evolution.edits import (
    ConstantChanged,
    ConstantRemoved,
    ConstantRenamed,
    EnumChanged,
    FieldRemoved,
    FieldRenamed,
    MessageEdit,
    Versions,
)
from ifgen.generator_py.messages.enums import enums, values
from ifgen.generator_py.names import enum_name


def lost_members(within: Versions, edits: Iterable[MessageEdit]) -> Iterator[EnumChanged]:
    """The enumerations that lack members which no other edit explains."""
    before, after = _members(within.old), _members(within.new)
    touched = set(_touched(edits))
    for name, constants in before.items():
        of_enum = {name, *(constant.name for constant in constants)}
        kept = {constant.name for constant in after.get(name, ())}
        lost = tuple(constant for constant in constants if constant.name not in kept)
        if lost and of_enum.isdisjoint(touched):
            field = next(field for field in within.new.fields if field.name == name)
            yield EnumChanged(within, field, enum_name(field), lost)


def _members(message: Message) -> Mapping[str, tuple[Constant, ...]]:
    """The constants of each enumeration, by the name of its field."""
    names = {enum.name for enum in enums(message)}
    return {field.name: owned for field, owned in values(message) if enum_name(field) in names}


def _touched(edits: Iterable[MessageEdit]) -> Iterator[str]:
    """The fields and constants whose own edits say enough."""
    for edit in edits:
        match edit:
            case FieldRemoved(_, field):
                yield field.name
            case ConstantRemoved(_, constant):
                yield constant.name
            case FieldRenamed(_, old) | ConstantRenamed(_, old) | ConstantChanged(_, old):
                yield old.name
            case _:
                pass

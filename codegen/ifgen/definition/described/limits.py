"""Limits for types from elsewhere: nesting that recursion can follow, and arrays that fit into memory."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from ifgen.definition.described.types import BadDescription
from ifgen.definition.interfaces import Message
from ifgen.definition.references import references
from ifgen.definition.types import Array, FieldType, NamespacedType

_DEEPEST: Final = 64
"""Levels of nesting: the deepest interface of ROS has 7."""

_LARGEST: Final = 2**27
"""Values in a default message, those in its arrays included."""


def check_limits(messages: Iterable[Message]) -> None:
    """Raise BadDescription if a message is nested too deeply or has too large arrays.

    The messages are a closed set without cycles.
    """
    known: dict[str, Message] = {message.type_name: message for message in messages}
    levels: dict[str, int] = {}
    values: dict[str, int] = {}
    pending = list(known)
    while pending:
        name = pending[-1]
        needed = {type_.type_name for _, type_ in references(known[name])}
        waiting = [other for other in needed if other not in levels]
        if waiting:
            pending += waiting
            continue
        pending.pop()
        levels[name] = 1 + max((levels[other] for other in needed), default=0)
        values[name] = sum(_values(field.type, values) for field in known[name].fields)
        if levels[name] > _DEEPEST:
            raise BadDescription(f"{name} is nested more than {_DEEPEST} levels deep")
        if values[name] > _LARGEST:
            raise BadDescription(f"a default message of {name} has more than {_LARGEST} values")


def _values(type_: FieldType, known: dict[str, int]) -> int:
    if isinstance(type_, Array):
        return type_.size * _values(type_.value_type, known)
    return known[type_.type_name] if isinstance(type_, NamespacedType) else 1

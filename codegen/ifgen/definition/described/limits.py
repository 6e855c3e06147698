"""Limits for types from elsewhere: nesting that recursion can follow, and arrays that fit into memory."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from ifgen.definition.described.types import BadDescription
from ifgen.definition.impossible import needed_first, value_count
from ifgen.definition.interfaces import Message
from ifgen.definition.references import references

_DEEPEST: Final = 64
"""Levels of nesting: the deepest interface of ROS has 7."""

_LARGEST: Final = 2**27
"""Values in a default message, those in its arrays included."""


def check_limits(messages: Iterable[Message]) -> None:
    """Raise BadDescription if a message is nested too deeply or has too large arrays.

    The messages are a closed set without cycles.
    """
    levels: dict[str, int] = {}
    values: dict[str, int] = {}
    for message in needed_first({message.type_name: message for message in messages}):
        name = message.type_name
        levels[name] = 1 + max((levels[type_.type_name] for _, type_ in references(message)), default=0)
        values[name] = sum(value_count(field.type, values) for field in message.fields)
        if levels[name] > _DEEPEST:
            raise BadDescription(f"{name} is nested more than {_DEEPEST} levels deep")
        if values[name] > _LARGEST:
            raise BadDescription(f"a default message of {name} has more than {_LARGEST} values")

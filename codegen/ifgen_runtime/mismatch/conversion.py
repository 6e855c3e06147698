"""Adapters between two classes of one type: those that are registered, and those that follow from these.

`ifgen adapt` writes adapters for messages and for the goal, the result and the feedback of an action. What
goes over the wire holds them in a field: `Walk_SendGoal_Request.goal`, `Path.poses`. So an adapter of the
whole follows, if all that differs are fields whose types have adapters.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ifgen_runtime.adapters import Adapter, adapter_for, in_class, unchanged
from ifgen_runtime.field_types import Field, fields_of

if TYPE_CHECKING:
    from collections.abc import Callable

    Convert = Callable[[Any], Any]


def adapter_between(theirs: type[Any], mine: type[Any]) -> Adapter | None:
    """The adapter from their class of a message type to mine; None if there is none.

    Both classes are at hand. The adapter's own `old` class may be a third one, of the same version as theirs.
    """
    registered = adapter_for(getattr(theirs, "__type_hash__", ""), mine)
    return registered or _derived(theirs, mine)


def _derived(theirs: type[Any], mine: type[Any]) -> Adapter | None:
    their_fields, my_fields = fields_of(theirs), fields_of(mine)
    if len(their_fields) != len(my_fields):
        return None
    up: dict[str, Convert | None] = {}
    down: dict[str, Convert | None] = {}
    can_go_down = True
    for their_field, my_field in zip(their_fields, my_fields, strict=True):
        if _without_type(their_field) != _without_type(my_field):
            return None
        slot = my_field.slot
        if not (isinstance(their_field.type, type) and isinstance(my_field.type, type)):
            if their_field.type != my_field.type:
                return None
            up[slot] = down[slot] = None
            continue
        inner = _adapter_of_part(their_field.type, my_field.type)
        if inner is None:
            return None
        can_go_down = can_go_down and inner.downgrade is not None
        each = _for_each if my_field.is_collection else _for_one
        up[slot] = each(inner.upgrade, inner.old)
        down[slot] = each(inner.downgrade or unchanged, my_field.type, their_field.type)
    return Adapter(theirs, mine, _by_fields(mine, up), _by_fields(theirs, down) if can_go_down else None)


def _adapter_of_part(theirs: type[Any], mine: type[Any]) -> Adapter | None:
    if theirs.__type_hash__ == mine.__type_hash__:
        return Adapter(mine, mine, unchanged, unchanged)
    return adapter_between(theirs, mine)


def _without_type(field: Field) -> tuple[Any, ...]:
    return field.name, field.size, field.is_sequence, field.maximum


def _by_fields(cls: type[Any], conversions: dict[str, Convert | None]) -> Convert:
    """The function that makes a message of `cls` from another one with the same fields."""

    def convert(message: Any) -> Any:
        made = cls()
        for slot, conversion in conversions.items():
            value = getattr(message, slot)
            setattr(made, slot, value if conversion is None else conversion(value))
        return made

    return convert


def _for_one(convert: Convert, source: type[Any], target: type[Any] | None = None) -> Convert:
    """Convert a message of any class that has the version of `source`; `target` is the class wanted of it."""

    def convert_one(message: Any) -> Any:
        converted = convert(in_class(source, message))
        return converted if target is None else in_class(target, converted)

    return convert_one


def _for_each(convert: Convert, source: type[Any], target: type[Any] | None = None) -> Convert:
    one = _for_one(convert, source, target)
    return lambda messages: [one(message) for message in messages]

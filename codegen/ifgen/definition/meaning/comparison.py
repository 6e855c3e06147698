"""Compares the meanings of two fields: two versions of one, or two that a connection relates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from ifgen.definition.interfaces import Field, Message
from ifgen.definition.meaning.reading import meaning_of
from ifgen.definition.meaning.units import dimension, normal
from ifgen.definition.meaning.values import Meaning, range_words


@dataclass(frozen=True, slots=True)
class Difference:
    """An aspect that both meanings have, and have differently, in words for people.

    `is_scale` is true for units of one quantity, such as `deg` and `rad`: a factor lies between them.
    """

    aspect: Literal["unit", "frame", "range", "invalid value"]
    one: str
    other: str
    is_scale: bool = False


def mismatches(one: Meaning, other: Meaning) -> tuple[Difference, ...]:
    """The differences that make a value of one wrong as a value of the other: unit and frame.

    A side that says nothing differs from nothing. Neither does a frame that a field names.
    """
    return tuple(each for each in differences(one, other) if each.aspect in {"unit", "frame"})


def differences(one: Meaning, other: Meaning) -> tuple[Difference, ...]:
    """Everything that both meanings say, and say differently. Another spelling of a unit is no difference."""
    return tuple(_differences(one, other))


def field_mismatches(one: Message, other: Message) -> Iterator[tuple[Field, Field, Difference]]:
    """The mismatches between the fields of two messages that have the same names.

    For two definitions of one type, or for two types that an adapter or a relay connects.
    """
    fields = {field.name: field for field in other.fields}
    for field in one.fields:
        if (beside := fields.get(field.name)) is not None:
            for difference in mismatches(meaning_of(field), meaning_of(beside)):
                yield field, beside, difference


def _differences(one: Meaning, other: Meaning) -> Iterator[Difference]:
    if one.unit and other.unit and (normal(one.unit) or one.unit) != (normal(other.unit) or other.unit):
        quantity = dimension(one.unit)
        is_scale = quantity is not None and quantity == dimension(other.unit)
        yield Difference("unit", one.unit, other.unit, is_scale)
    frames = [_frame(each.frame) for each in (one, other) if each.frame and not each.frame.startswith("@")]
    if len(set(frames)) > 1:
        yield Difference("frame", one.frame or "", other.frame or "")
    if one.range and other.range and one.range != other.range:
        yield Difference("range", range_words(one.range), range_words(other.range))
    if one.invalid and other.invalid and one.invalid.spelled != other.invalid.spelled:
        yield Difference("invalid value", one.invalid.spelled, other.invalid.spelled)


def _frame(name: str) -> str:
    """A frame without what spellings differ in: `/map` and `map`, `NED` and `ned`."""
    return name.strip().removeprefix("/").casefold()

"""The meaning of a field as a value, and in words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from ifgen.definition.meaning.units import NO_UNIT

Number: TypeAlias = int | float


@dataclass(frozen=True, slots=True)
class Range:
    """The smallest and the largest value; None where there is no bound."""

    minimum: Number | None = None
    maximum: Number | None = None

    @property
    def is_empty(self) -> bool:
        """True if no number is in it."""
        return self.minimum is not None and self.maximum is not None and self.minimum > self.maximum

    def __contains__(self, value: Number) -> bool:
        above = self.minimum is None or value >= self.minimum
        return above and (self.maximum is None or value <= self.maximum)


@dataclass(frozen=True, slots=True)
class Invalid:
    """The value that stands for "no valid data", NaN mostly, and when it does."""

    value: Number
    when: str = ""

    @property
    def spelled(self) -> str:
        """The value as people write it: `NaN`, `-1`."""
        return "NaN" if math.isnan(self.value) else str(self.value)


@dataclass(frozen=True, slots=True)
class Meaning:
    """The meaning of a field or a constant.

    `unit` has its author's spelling; `units.normal` makes two of them comparable. `NO_UNIT` says that the
    number has none. `enum` are prefixes of constants, without the last `_`. A `frame` that begins with `@`
    names the field or the constant that names the frame. `deprecated` is the advice, empty without one, None
    if the field is not deprecated.
    """

    unit: str | None = None
    range: Range | None = None
    enum: tuple[str, ...] = ()
    frame: str | None = None
    invalid: Invalid | None = None
    deprecated: str | None = None

    def __bool__(self) -> bool:
        return self != NOTHING


_ANGLES: Final = {
    sign * value: f"{'-' if sign < 0 else ''}{name}"
    for value, name in ((math.pi, "pi"), (2 * math.pi, "2 pi"), (math.pi / 2, "pi/2"))
    for sign in (1, -1)
}
NOTHING: Final = Meaning()
"""The meaning of a field whose comment and annotations say nothing about it."""


def words(meaning: Meaning) -> str:
    """The meaning in a few words: `unit m/s, 0 to 3, frame NED, NaN: no data`; empty for `NOTHING`."""
    return ", ".join(_words(meaning))


def bracketed(meaning: Meaning) -> str:
    """The meaning as a comment may have it: `[m/s]`, `[m/s, 0 to 3, frame NED]`; empty for `NOTHING`."""
    unit = [meaning.unit] if meaning.unit else []
    found = ", ".join([*unit, *_words(replace(meaning, unit=None))])
    return f"[{found}]" if found else ""


def range_words(range_: Range) -> str:
    """A range in words: `0 to 3`, `at least 0`."""
    low, high = map(_spelled, (range_.minimum, range_.maximum))
    return f"at most {high}" if low is None else f"at least {low}" if high is None else f"{low} to {high}"


def _spelled(value: Number | None) -> str | None:
    return None if value is None else _ANGLES.get(value, str(value))


def _words(meaning: Meaning) -> Iterator[str]:
    if meaning.unit:
        yield "no unit" if meaning.unit == NO_UNIT else f"unit {meaning.unit}"
    if meaning.range:
        yield range_words(meaning.range)
    if meaning.enum:
        yield " or ".join(f"{name}_*" for name in meaning.enum)
    if meaning.frame:
        yield f"frame {meaning.frame}"
    if meaning.invalid:
        yield f"{meaning.invalid.spelled}: {meaning.invalid.when or 'no data'}"
    if meaning.deprecated is not None:
        yield f"deprecated: {meaning.deprecated}" if meaning.deprecated else "deprecated"

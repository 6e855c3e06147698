"""Two meanings side by side: what makes a value of one wrong as a value of the other."""

from __future__ import annotations

import math

import pytest
from ifgen.definition.interfaces import Field, Message
from ifgen.definition.meaning.comparison import Difference, differences, field_mismatches, mismatches
from ifgen.definition.meaning.values import Invalid, Meaning, Range
from ifgen.definition.types import BasicType


@pytest.mark.parametrize(
    ("one", "other", "found"),
    [
        (Meaning(unit="m/s"), Meaning(unit="metres per second"), ()),
        (Meaning(unit="deg"), Meaning(unit="rad"), (Difference("unit", "deg", "rad", is_scale=True),)),
        (Meaning(unit="m"), Meaning(unit="s"), (Difference("unit", "m", "s"),)),
        (Meaning(unit="m"), Meaning(), ()),
        (Meaning(unit="furlong"), Meaning(unit="furlong"), ()),
        (Meaning(frame="map"), Meaning(frame="/map"), ()),
        (Meaning(frame="NED"), Meaning(frame="ENU"), (Difference("frame", "NED", "ENU"),)),
        (Meaning(frame="@pose_frame"), Meaning(frame="ENU"), ()),
        (Meaning(range=Range(0, 1)), Meaning(range=Range(0, 2)), ()),
    ],
)
def test_mismatches(one: Meaning, other: Meaning, found: tuple[Difference, ...]) -> None:
    assert mismatches(one, other) == found
    assert len(mismatches(other, one)) == len(found)


def test_differences_of_two_versions() -> None:
    one = Meaning(range=Range(0, 1), invalid=Invalid(math.nan))
    assert differences(one, Meaning(range=Range(0, 2), invalid=Invalid(-1))) == (
        Difference("range", "0 to 1", "0 to 2"),
        Difference("invalid value", "NaN", "-1"),
    )
    assert differences(one, Meaning(range=Range(0.0, 1.0), invalid=Invalid(math.nan))) == ()


def message(**units: str) -> Message:
    fields = tuple(Field(name, BasicType("double"), unit=unit) for name, unit in units.items())
    return Message("demo_msgs", "msg", "Demo", fields)


def test_fields_of_the_same_name() -> None:
    found = list(field_mismatches(message(a="m", b="deg", c="s"), message(b="rad", a="m", d="V")))
    assert [(one.name, other.name, difference.aspect) for one, other, difference in found] == [
        ("b", "b", "unit")
    ]

"""Units: one spelling for all that mean the same, and what they measure."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen.definition.meaning.units import dimension, is_unit, normal

SAME = [
    ("m/s", "m/sec", "metres/sec", "metres per second", "m s-1", "m*s^-1", "m.s^-1"),
    ("m/s^2", "m/s/s", "m/s**2", "m/s\u00b2", "meters per second squared"),
    ("m^2/s^2", "(m/s)^2", "m^2 s^-2"),
    ("us", "microseconds", "\u00b5s", "usec", "microsecond"),
    ("degC", "\u00b0C", "degrees Celsius", "Degrees Celsius", "celsius"),
    ("deg", "degrees", "\u00b0"),
    ("kg*m^2", "kg-m^2", "kg m^2"),
    ("N*m", "Nm", "N m", "newton meters"),
    ("-", "1"),
    ("%", "percent"),
    ("px", "pixels"),
    ("rad", "radians"),
]
UNKNOWN = [
    "",
    " ",
    "bool",
    "norm",
    "enum",
    "0",
    "0-9",
    "1-99",
    "i",
    "u v",
    "fx 0 cx",
    "m/",
    "/m",
    "(m",
    "m)",
    "m^",
    "x" * 99,
]


@pytest.mark.parametrize("spellings", SAME, ids=lambda group: group[0])
def test_spellings(spellings: tuple[str, ...]) -> None:
    assert {normal(each) for each in spellings} == {spellings[0]}


@pytest.mark.parametrize("text", UNKNOWN)
def test_no_units(text: str) -> None:
    assert normal(text) is None


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("deg", "rad"),
        ("km/h", "m/s"),
        ("rpm", "deg/s"),
        ("mAh", "A s"),
        ("V", "W/A"),
        ("degC", "K"),
        ("ft", "mm"),
    ],
)
def test_one_dimension(one: str, other: str) -> None:
    assert normal(one) != normal(other)
    assert dimension(one) == dimension(other) is not None


def test_an_index_is_no_unit() -> None:
    assert [is_unit(text) for text in ("rad", "m/s^2", "i", "0", "bit", "byte")] == [
        True,
        True,
        False,
        False,
        False,
        False,
    ]


@given(st.text("msradkgN/*^()-. 120%\u00b0\u00b2per", max_size=20))
def test_the_normal_spelling_is_its_own(text: str) -> None:
    found = normal(text)
    assert found is None or (normal(found), dimension(found)) == (found, dimension(text))

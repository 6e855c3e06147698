"""YAML of users in messages."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen.dynamic import class_from_text
from ifgen_tools.errors import ToolError
from ifgen_tools.texts.set_fields import read_yaml, set_fields

DEFINITION = """\
std_msgs/Header header
builtin_interfaces/Time at
float64[2] pair
int8 small
uint8[] blob
string text "default"
bool flag
byte one
geometry_msgs/Point[<=2] points
string[] names
string<=4 short
string<=2[] shorts
"""


CLASS: type[Any] = class_from_text("demo_msgs/msg/Filled", DEFINITION)


@pytest.fixture
def message() -> Any:
    return CLASS()


def test_what_is_not_mentioned_keeps_its_default(message: Any) -> None:
    text = (
        "{small: -3, pair: [1, 1e-3], points: [{x: 0.1}], one: 7, blob: !!binary AAE=, names: [a], flag: 1}"
    )
    assert set_fields(message, read_yaml(text)) == []
    assert (message.small, list(message.pair), message.text) == (-3, [1.0, 0.001], "default")
    assert (message.points[0].x, message.points[0].y) == (0.1, 0.0)
    assert (message.one, bytes(message.blob), message.names, message.flag) == (b"\x07", b"\0\1", ["a"], True)
    set_fields(message, None)
    set_fields(message, {"text": 5})
    assert message.text == "5"  # as in ROS


def test_floats_that_are_no_numbers(message: Any) -> None:
    set_fields(message, read_yaml("pair: [.nan, inf]"))
    assert math.isnan(message.pair[0])
    assert message.pair[1] == math.inf


def test_the_time_of_sending(message: Any) -> None:
    stamps = set_fields(message, read_yaml("{header: auto, at: now}"))
    stamp = type(message.at)(sec=7)
    for set_stamp in stamps:
        set_stamp(stamp)
    assert (message.header.stamp.sec, message.at.sec) == (7, 7)


@pytest.mark.parametrize(
    ("text", "expected", "help"),
    [
        (
            "hello",
            'the message: expected the fields of demo_msgs/msg/Filled, got "hello"',
            "write {header: ...",
        ),
        ("{smal: 1}", "demo_msgs/msg/Filled has no field 'smal'", "did you mean 'small'?"),
        (
            "{header: {frame: a}}",
            "std_msgs/msg/Header has no field 'header.frame'",
            "did you mean 'frame_id'?",
        ),
        (
            "{header: 5}",
            "the value of 'header': expected the fields of std_msgs/msg/Header, got 5",
            "write {stamp",
        ),
        ("{small: 128}", "the value of 'small': expected int8, which is -128 to 127, got 128", ""),
        ("{small: 1.5}", "the value of 'small': expected an integer (int8), got 1.5", ""),
        ("{small: yes}", "the value of 'small': expected an integer (int8), got true", ""),
        ("{pair: [1]}", "'pair' has 2 elements, and 1 are given", ""),
        ("{pair: [1, fast]}", "the value of 'pair[1]': expected a number, got \"fast\"", ""),
        ("{pair: 3}", "the value of 'pair': expected a list of double, got 3", ""),
        ("{points: [{}, {}, {}]}", "'points' has at most 2 elements, and 3 are given", ""),
        (
            "{points: [{x: 1, w: 2}]}",
            "geometry_msgs/msg/Point has no field 'points[0].w'",
            "its fields are x, y, z",
        ),
        ("{text: yes}", "the value of 'text': expected text, got true", "put it in quotes within the YAML"),
        (
            '{text: "\\ud800"}',
            "the value of 'text' does not fit: character 0 is half of a surrogate pair, or a byte that is no UTF-8",
            "",
        ),
        (
            '{text: "a\\0b"}',
            "the value of 'text' does not fit: a text cannot hold a NUL: strings of ROS end there",
            "",
        ),
        ("{short: abcdef}", "'short' has at most 4 characters, and 6 are given", ""),
        ("{shorts: [ab, abc]}", "'shorts[1]' has at most 2 characters, and 3 are given", ""),
        ("{flag: maybe}", "the value of 'flag': expected true or false, got \"maybe\"", ""),
        ("{one: 256}", "the value of 'one': expected uint8, which is 0 to 255, got 256", ""),
        (
            "{names: [null]}",
            "the value of 'names[0]': expected text, got null",
            "put it in quotes within the YAML",
        ),
    ],
)
def test_what_is_wrong_is_named(message: Any, text: str, expected: str, help: str) -> None:
    with pytest.raises(ToolError) as caught:
        set_fields(message, read_yaml(text))
    assert caught.value.message == expected
    assert caught.value.help.startswith(help)


def test_what_is_no_yaml() -> None:
    with pytest.raises(ToolError, match=r"the values are no YAML: .* at line 1, column 6"):
        read_yaml("{a: }]")


SCALARS = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=3)
    | st.binary(max_size=3)
    | st.dates()
)
NAMES = st.sampled_from(
    [
        "header",
        "stamp",
        "sec",
        "at",
        "pair",
        "small",
        "blob",
        "text",
        "flag",
        "one",
        "points",
        "x",
        "names",
        "?",
    ]
)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES | SCALARS, inner, max_size=4)
)


@given(VALUES)
def test_whatever_it_is_there_is_a_message_or_one_error(values: Any) -> None:
    message = CLASS()
    try:
        set_fields(message, values)
    except ToolError as error:
        assert error.message
    else:
        assert type(message).__deserialize__(message.__serialize__()) is not None


def test_a_very_long_number(message: Any) -> None:
    with pytest.raises(ToolError, match="expected a list of double, got a very long number"):
        set_fields(message, {"pair": 10**5000})


def test_characters_of_idl() -> None:
    """`char` in IDL is a character, and one that is no number."""
    text = "module demo_msgs { module msg { struct Letter { char one; }; }; };"
    cls = class_from_text("demo_msgs/msg/Letter", text, idl=True)
    message = cls()
    set_fields(message, read_yaml("{one: a}", "the values"))
    assert message.one == "a"
    with pytest.raises(ToolError, match="the value of 'one': expected one character, got \"ab\""):
        set_fields(cls(), read_yaml("{one: ab}", "the values"))

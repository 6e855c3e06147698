"""Meaning in comments: PX4's tags, the habits of ROS, annotations; and what looks alike but is none."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen.definition.build import interface
from ifgen.definition.interfaces import Field, Interface, Message
from ifgen.definition.meaning.reading import deprecation_of, meaning_of, mistakes_of, reading_of
from ifgen.definition.meaning.units import normal
from ifgen.definition.meaning.values import NOTHING, Invalid, Meaning, Range, words
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Diagnostic, Source

REPOSITORY = Path(__file__).parents[3]


@dataclass(frozen=True)
class Row:
    """A type and a comment, with the meaning of the field that has both."""

    type: str
    comment: str
    meaning: Meaning
    text: str = ""


NAN = Invalid(math.nan)
ROWS = [
    # PX4's standard
    Row("uint64", "[us] Time since boot", Meaning(unit="us"), "Time since boot"),
    Row("float32", "[m/s] [@invalid NaN] Speed", Meaning(unit="m/s", invalid=NAN), "Speed"),
    Row("float32", "[-] Ratio", Meaning(unit="-"), "Ratio"),
    Row("uint8", "[@enum SOURCE] Where from", Meaning(enum=("SOURCE",)), "Where from"),
    Row("uint8", "[@enum WARNING STATE] How bad", Meaning(enum=("WARNING", "STATE")), "How bad"),
    Row("uint8", "[@enum A, B] Which", Meaning(enum=("A", "B")), "Which"),
    Row("float32", "[@range 0, 3] Gain", Meaning(range=Range(0, 3)), "Gain"),
    Row(
        "float32", "[@range 0,1] [@invalid -1] Rest", Meaning(range=Range(0, 1), invalid=Invalid(-1)), "Rest"
    ),
    Row("float32", "[-] [@range 1,] Scale", Meaning(unit="-", range=Range(1)), "Scale"),
    Row("float32", "[@range , 3] Gain", Meaning(range=Range(None, 3)), "Gain"),
    Row("float32", "[m] [@range 0, inf] Radius", Meaning(unit="m", range=Range(0)), "Radius"),
    Row(
        "float32", "[m/s] [@range -inf, INF] [@frame Body] Speed", Meaning(unit="m/s", frame="Body"), "Speed"
    ),
    Row("float32", "[@range -1 (Left), 1 (Right)] Steering", Meaning(range=Range(-1, 1)), "Steering"),
    Row(
        "float32",
        "[rad] [@range -pi, pi] Course",
        Meaning(unit="rad", range=Range(-math.pi, math.pi)),
        "Course",
    ),
    Row("float32", "[@range -2*pi, pi/2]", Meaning(range=Range(-2 * math.pi, math.pi / 2))),
    Row("float32", "[m] [@frame @local_frame] Place", Meaning(unit="m", frame="@local_frame"), "Place"),
    Row("float32", "[@frame local frame] Place", Meaning(frame="local frame"), "Place"),
    Row("float32", "[@invalid NaN If no wheel] X", Meaning(invalid=Invalid(math.nan, "If no wheel")), "X"),
    Row("uint16", "[@invalid UINT16_MAX] Distance", Meaning(invalid=Invalid(65535)), "Distance"),
    Row("uint8", "[@range 0x10, 1e2]", Meaning(range=Range(16, 100.0))),
    Row("float32", "[°C] [@invalid NaN] Warmth", Meaning(unit="°C", invalid=NAN), "Warmth"),
    Row("float32", "[%] [@range 0, 100] Charge", Meaning(unit="%", range=Range(0, 100)), "Charge"),
    Row("float32[3]", "[m] [@range -5, 5] Place", Meaning(unit="m", range=Range(-5, 5)), "Place"),
    Row(
        "float32",
        "Filtered airspeed derivative [m/s/s]",
        Meaning(unit="m/s/s"),
        "Filtered airspeed derivative",
    ),
    # the habits of ROS
    Row("float32", "start angle [rad]", Meaning(unit="rad"), "start angle"),
    Row("float32", "time in seconds", Meaning(unit="seconds"), "time in seconds"),
    Row("float32", "how fast, in m/s.", Meaning(unit="m/s"), "how fast, in m/s."),
    Row("float32", "unit: m/s", Meaning(unit="m/s"), "unit: m/s"),
    Row(
        "float32",
        "units are meters per second",
        Meaning(unit="meters per second"),
        "units are meters per second",
    ),
    Row("float32", "Warmth in degrees Celsius", Meaning(unit="degrees Celsius"), "Warmth in degrees Celsius"),
    Row("uint64", "since boot (microseconds)", Meaning(unit="microseconds"), "since boot (microseconds)"),
    Row("float32", "shortest distance (in m)", Meaning(unit="m"), "shortest distance (in m)"),
    Row(
        "float32",
        "Charge in Ah (If unmeasured NaN)",
        Meaning(unit="Ah", invalid=NAN),
        "Charge in Ah (If unmeasured NaN)",
    ),
    Row(
        "float32",
        "Current in amperes, -1 if unknown",
        Meaning(unit="amperes", invalid=Invalid(-1)),
        "Current in amperes, -1 if unknown",
    ),
    Row("float32", "set to NaN if not known", Meaning(invalid=NAN), "set to NaN if not known"),
    Row("float32", "@deprecated use speed", Meaning(deprecated="use speed")),
    Row("float32", "[@deprecated use speed] Old", Meaning(deprecated="use speed"), "Old"),
    Row("float32", "[[deprecated]]", Meaning(deprecated="")),
    Row("float32", 'Old [[deprecated("use speed")]]', Meaning(deprecated="use speed"), "Old"),
    Row("float32", "DEPRECATED: use speed", Meaning(deprecated="use speed")),
    Row("float32", "Deprecated since Jazzy.", Meaning(deprecated="since Jazzy.")),
    # what looks alike
    Row("float32", "one of [0.0-1.0]", NOTHING, "one of [0.0-1.0]"),
    Row("float32", "[0, 1] Part", NOTHING, "[0, 1] Part"),
    Row("uint8", "[1-99]", NOTHING, "[1-99]"),
    Row("bool", "[bool] On", NOTHING, "On [bool]"),
    Row("float32", "[norm] Stick", NOTHING, "Stick [norm]"),
    Row("uint8", "[enum] Kind", NOTHING, "Kind [enum]"),
    Row("uint8", "[enum KIND] Kind", NOTHING, "Kind [enum KIND]"),
    Row("float32", "[fx 0 cx] and [0 fy cy]", NOTHING, "[fx 0 cx] and [0 fy cy]"),
    Row("float32", "of values[i]", NOTHING, "of values [i]"),
    Row(
        "float32",
        "in order, in the map, in use, in A or B",
        NOTHING,
        "in order, in the map, in use, in A or B",
    ),
    Row("float32", "in m and rad", NOTHING, "in m and rad"),
    Row("float32", "in m, or in feet", NOTHING, "in m, or in feet"),
    Row("float64[36]", "row by row, in m", NOTHING, "row by row, in m"),
    Row("string", "[COMPRESSED] in meters", NOTHING, "in meters [COMPRESSED]"),
    Row("float32", "see [@porkate/core] and @me", NOTHING, "see and @me [@porkate/core]"),
    Row("float32", "not deprecated", NOTHING, "not deprecated"),
    Row("float32", "[@uncontrolled NAN to stop] Throttle", NOTHING, "[@uncontrolled NAN to stop] Throttle"),
]
"""Descriptions are ours; the forms of tags are those that PX4's messages have."""


def read(text: str, name: str = "demo_msgs/msg/Demo.msg") -> tuple[Interface, list[Diagnostic]]:
    source = Source(Path(name), text)
    problems = FileProblems(source)
    found = interface(source, "demo_msgs", "msg", "Demo", problems)
    return found, problems.errors() + problems.warnings()


def field(text: str, name: str = "demo_msgs/msg/Demo.msg") -> Field:
    message, _ = read(text, name)
    assert isinstance(message, Message)
    return message.fields[-1]


def same(one: Meaning, other: Meaning) -> bool:
    """Equal, where NaN equals NaN."""
    return repr(one) == repr(other)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.comment)
def test_forms(row: Row) -> None:
    found = reading_of(field(f"{row.type} x  # {row.comment}\n"))
    assert same(found.meaning, row.meaning), words(found.meaning)
    assert (found.text, found.mistakes) == (row.text, ())


def test_comment_lines_above_and_below() -> None:
    above = field("float32 other\n# [m]\n# How far,\n# [@range 0, 5] as the crow flies\nfloat32 x\n")
    assert meaning_of(above) == Meaning(unit="m", range=Range(0, 5))
    below = field("float32 x  # [m] How far,\n           # [@range 0, 5] as the crow flies\n")
    assert meaning_of(below) == Meaning(unit="m", range=Range(0, 5))


@pytest.mark.parametrize(
    ("annotations", "meaning"),
    [
        ('@unit (value="m/s")', Meaning(unit="m/s")),
        ("@range (min=0, max=3)", Meaning(range=Range(0, 3))),
        ("@range (min=0.5)", Meaning(range=Range(0.5))),
        ("@min (1) @max (value=9)", Meaning(range=Range(1, 9))),
        ("@deprecated", Meaning(deprecated="")),
        ('@deprecated (value="use y")', Meaning(deprecated="use y")),
        ('@verbatim (language="comment", text="[@range 0, 3] Gain")', Meaning(range=Range(0, 3))),
    ],
)
def test_annotations(annotations: str, meaning: Meaning) -> None:
    text = f"module demo_msgs {{ module msg {{ struct Demo {{ {annotations} double x; }}; }}; }};"
    assert meaning_of(field(text, "demo_msgs/msg/Demo.idl")) == meaning


def test_messages_may_be_deprecated() -> None:
    found = {
        text: deprecation_of(message)
        for text in (
            "# Deprecated: use Pose\n\nint8 x\n",
            "# @deprecated\n\nint8 x\n",
            "# A pose\n\nint8 x\n",
        )
        if isinstance(message := read(text)[0], Message)
    }
    assert list(found.values()) == ["use Pose", "", None]


MISTAKES = [
    ("float32", "[@range 0 3]", "a range has two bounds, with a comma between them"),
    ("float32", "[@range]", "a range has two bounds, with a comma between them"),
    ("float32", "[@range low, high]", "`low` is not a number"),
    ("float32", "[@range 3, 0]", "the range 3, 0 is empty"),
    ("float32", "[@range 0, 3", "`@range` has no closing bracket"),
    ("string", "[@range 0, 3]", "`@range` is for numbers, and this field holds none"),
    ("float32", "[@enum MODE]", "`@enum` is for integers, and this field holds none"),
    ("uint8", "[@enum]", "`@enum` names no prefix of constants"),
    ("uint8", "[@enum MODE]", "no constant of this message begins with `MODE_`"),
    ("float32", "[@frame]", "`@frame` names no frame"),
    ("float32", "[@invalid never]", "`@invalid` names no value"),
    ("uint8", "[@invalid NaN]", "an integer is never NaN"),
    ("float32", "[@rang 0, 3]", "there is no tag `@rang`"),
    ("float32", "[m] [@range 0, 1] [@range 0, 3]", "there are two `@range`"),
]


@pytest.mark.parametrize(("type_", "comment", "message"), MISTAKES, ids=lambda text: text)
def test_mistakes(type_: str, comment: str, message: str) -> None:
    _, (found,) = read(f"uint8 OTHER_ONE=1\n{type_} x  # {comment} Words\n")
    assert (found.rule, found.severity, found.message) == ("invalid-tag", "warning", message)
    assert found.primary is not None
    span = found.primary.span
    marked = span.source.text[span.start : span.end]
    assert marked in comment or (marked == f"{comment} Words" and "closing" in message)
    assert span.source.text[: span.start].count("\n") == 1


def test_a_mistake_above_its_field_is_marked_there() -> None:
    _, (found,) = read("float32 a  # [@range 0, 3]\n# [@range 3, 0]\nfloat32 b\n")
    assert found.primary is not None
    assert found.primary.span.source.position(found.primary.span.start)[0] == 2


def test_a_range_of_an_idl_file_without_numbers() -> None:
    text = "module demo_msgs { module msg { struct Demo { @range (min=3, max=0) double x; }; }; };"
    _, (found,) = read(text, "demo_msgs/msg/Demo.idl")
    assert (found.rule, found.message) == ("invalid-tag", "no number is in this range")


NUMBERS = st.integers(-(10**6), 10**6) | st.floats(-1e6, 1e6)
NAMES = st.text("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789", min_size=1, max_size=8).map(
    lambda text: f"A{text}".rstrip("_")
)
RANGES = st.tuples(NUMBERS | st.none(), NUMBERS | st.none()).map(
    lambda pair: None if pair == (None, None) else Range(*(pair if None in pair else sorted(pair)))
)
MEANINGS = st.builds(
    Meaning,
    unit=st.sampled_from(["m", "m/s", "rad/s^2", "%", "-", "degC", None]),
    range=RANGES,
    enum=st.just(()),
    frame=st.sampled_from(["NED", "Body", "@frame_id", "local frame", None]),
    invalid=st.builds(Invalid, NUMBERS | st.just(math.nan), st.sampled_from(["", "If unknown"])) | st.none(),
)


def written(meaning: Meaning) -> str:
    """A comment that says this."""
    tags = [f"[{meaning.unit}]"] if meaning.unit else []
    if meaning.range:
        low, high = meaning.range.minimum, meaning.range.maximum
        tags.append(f"[@range {'' if low is None else low}, {'' if high is None else high}]")
    if meaning.frame:
        tags.append(f"[@frame {meaning.frame}]")
    if meaning.invalid:
        tags.append(f"[@invalid {meaning.invalid.value} {meaning.invalid.when}]".replace(" ]", "]"))
    return " ".join([*tags, "A description"])


@given(MEANINGS)
def test_drawn_tags_come_back(meaning: Meaning) -> None:
    found = reading_of(field(f"float64 x  # {written(meaning)}\n"))
    assert same(found.meaning, meaning)
    assert (found.text, found.mistakes) == ("A description", ())


@given(st.lists(NAMES, min_size=1, max_size=3, unique=True))
def test_drawn_enumerations_come_back(names: list[str]) -> None:
    constants = "".join(f"uint8 {name}_X{number}={number}\n" for number, name in enumerate(names))
    message, problems = read(f"{constants}uint8 x  # [@enum {' '.join(names)}]\n")
    assert isinstance(message, Message)
    assert (meaning_of(message.fields[0]).enum, problems) == (tuple(names), [])


PIECES = st.sampled_from(
    """
    [ ] [@ @ range enum frame invalid deprecated unit [[ ]] ( ) , - 0 3 1e999 0x inf NaN pi nan if in m/s rad
    [m] [@range [@enum MODE \u00b0 \u00b5s ^ ** / per unit: unknown -1 \\ " ' # \U0001f916
    """.split()  # noqa: SIM905  # a list of thirty strings is harder to read
)


@given(
    st.lists(PIECES | st.text(max_size=3), max_size=14),
    st.sampled_from(["float32", "uint8", "string", "bool[]"]),
)
def test_no_comment_raises(pieces: list[str], type_: str) -> None:
    text = " ".join(pieces).replace("\n", " ").replace("\r", " ").replace("\0", " ")
    message, problems = read(f"uint8 MODE_A=1\n{type_} x  # {text}\n")
    assert isinstance(message, Message)
    for each in message.fields:
        found = reading_of(each)
        assert list(mistakes_of(each, ["MODE_A"])) or not found.mistakes
        words(found.meaning)
        if found.meaning.unit:
            normal(found.meaning.unit)
    for problem in problems:
        assert problem.primary is not None
        span = problem.primary.span
        assert 0 <= span.start <= span.end <= len(span.source.text)


def bundled() -> list[Path]:
    """The definitions in the repository and in the wheels of ROS."""
    folders = [REPOSITORY / "interfaces", Path(sys.prefix) / "share"]
    return sorted(path for folder in folders for path in folder.rglob("*.msg"))


def test_nothing_else_is_a_tag() -> None:
    """All comments of messages here: no tag, no mistake, and only what is a unit is one."""
    units: set[str] = set()
    for path in bundled():
        source = Source(path, path.read_text(encoding="utf-8"))
        message = interface(source, path.parent.parent.name, "msg", path.stem, FileProblems(source))
        assert isinstance(message, Message)
        for each in message.fields:
            found = reading_of(each)
            assert found.mistakes == (), each
            assert replace(found.meaning, unit=None, invalid=None) == NOTHING, each
            units |= {found.meaning.unit} if found.meaning.unit else set()
    unknown = {unit for unit in units if normal(unit) is None}
    assert unknown <= {"device-specific units"}
    assert len(units) >= 15

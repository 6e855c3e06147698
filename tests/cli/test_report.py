"""Diagnostics as people and tools see them: golden texts at 80 columns."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen.command_kit import report
from ifgen.diagnostics import Diagnostic, Label, Source, Span

POSE = Source(Path("demo_msgs/msg/Pose.msg"), "# A pose.\nfloat64 x\n\nfloat64 x\n")


def span(source: Source, text: str, occurrence: int = 0) -> Span:
    start = -1
    for _ in range(occurrence + 1):
        start = source.text.index(text, start + 1)
    return Span(source, start, start + len(text))


def label(source: Source, text: str, said: str = "", occurrence: int = 0) -> Label:
    return Label(span(source, text, occurrence), said)


DUPLICATE = Diagnostic(
    "duplicate-field",
    "field 'x' is declared twice",
    label(POSE, "x", "declared again", 1),
    (label(POSE, "x", "first declared here"),),
    "rename one of them",
)


def plain(*diagnostics: Diagnostic, width: int = 80) -> str:
    return report.for_people(diagnostics, width).plain


def test_two_places_in_one_file() -> None:
    assert plain(DUPLICATE) == (
        "error[duplicate-field]: field 'x' is declared twice\n"
        " --> demo_msgs/msg/Pose.msg:4:9\n"
        "  |\n"
        "2 | float64 x\n"
        "  |         - first declared here\n"
        "4 | float64 x\n"
        "  |         ^ declared again\n"
        "  = help: rename one of them\n"
    )


def test_another_file_and_no_file() -> None:
    other = Source(Path("demo_msgs/msg/pose.msg"), "\n" * 99 + "int32 y\n")
    diagnostics = (
        Diagnostic("clash", "they clash", label(POSE, "float64"), (label(other, "int32", "with this"),)),
        Diagnostic("missing", "there is no package 'nav'", help="add -I DIR", severity="warning"),
    )
    assert plain(*diagnostics) == (
        "error[clash]: they clash\n"
        "   --> demo_msgs/msg/Pose.msg:2:1\n"
        "    |\n"
        "  2 | float64 x\n"
        "    | ^^^^^^^\n"
        "   ::: demo_msgs/msg/pose.msg:100:1\n"
        "    |\n"
        "100 | int32 y\n"
        "    | ----- with this\n"
        "\n"
        "warning[missing]: there is no package 'nav'\n"
        "  = help: add -I DIR\n"
    )
    assert report.summary(diagnostics) == "1 error, 1 warning"


def test_tabs_wide_and_control_characters_stay_aligned() -> None:
    source = Source(Path("a.msg"), "\tint32 机器人\u0301 e\u0301x \x1b[31mred")
    found = plain(
        Diagnostic("r", "wide \x1b[2J", label(source, "red", "here"), (label(source, "机器人", "robot"),))
    )
    assert found == (
        "error[r]: wide ␛[2J\n"
        " --> a.msg:1:22\n"
        "  |\n"
        "1 |     int32 机器人\u0301 e\u0301x ␛[31mred\n"
        "  |                          ^^^ here\n"
        "  |           ------ robot\n"
    )


def test_long_lines_are_cropped_around_the_place() -> None:
    source = Source(Path("a.msg"), "string s " + "a" * 200 + " BAD " + "b" * 200)
    found = plain(Diagnostic("r", "long", label(source, "BAD", "this is the place, and this is why")))
    lines = found.splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[3].startswith("1 | …aaa")
    assert lines[3].endswith("bbb…")
    column = lines[3].index("BAD")
    assert lines[4] == "  | " + " " * (column - 4) + "^^^ this is the place, and this is why"


def test_help_is_wrapped_with_its_indent() -> None:
    lines = plain(Diagnostic("r", "m", label(POSE, "x"), help="one two three " * 10)).splitlines()
    assert lines[5].startswith("  = help: one two")
    assert all(line.startswith(" " * 10 + "o") or line.startswith(" " * 10 + "t") for line in lines[6:])
    assert max(map(len, lines)) <= 80


def test_colours_are_styles_not_text() -> None:
    text = report.for_people([DUPLICATE])
    assert "\x1b" not in text.plain
    assert {str(s.style) for s in text.spans} >= {"bold red", "bold blue", "bold cyan", "bold green"}


@given(
    st.text(max_size=300), st.integers(0, 300), st.integers(0, 50), st.text(max_size=60), st.integers(20, 120)
)
def test_any_text_can_be_reported(text: str, start: int, length: int, said: str, width: int) -> None:
    start = min(start, len(text))
    where = Label(Span(Source(Path("a.msg"), text), start, min(start + length, len(text))), said)
    found = plain(Diagnostic("r", said, where, (where,), said), width=width)
    assert not any(c < " " for c in found.replace("\n", ""))
    json.loads(report.as_json([Diagnostic("r", said, where)]))
    assert "\n" not in report.as_github_annotations([Diagnostic("r", said, where, (), said)])


def test_json() -> None:
    assert json.loads(report.as_json([DUPLICATE])) == {
        "version": 1,
        "errors": 1,
        "warnings": 0,
        "diagnostics": [
            {
                "rule": "duplicate-field",
                "severity": "error",
                "message": "field 'x' is declared twice",
                "help": "rename one of them",
                "labels": [
                    {
                        "path": "demo_msgs/msg/Pose.msg",
                        "start": {"line": 4, "column": 9},
                        "end": {"line": 4, "column": 10},
                        "text": "declared again",
                        "primary": True,
                    },
                    {
                        "path": "demo_msgs/msg/Pose.msg",
                        "start": {"line": 2, "column": 9},
                        "end": {"line": 2, "column": 10},
                        "text": "first declared here",
                        "primary": False,
                    },
                ],
            }
        ],
    }


def test_github_annotations_escape_what_would_end_them(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    source = Source(tmp_path / "a,b:c%.msg", "x\ny\n")
    found = report.as_github_annotations(
        [Diagnostic("r", "100%\nsure", label(source, "y"), help="ok"), DUPLICATE]
    )
    assert found.splitlines() == [
        "::error file=a%2Cb%3Ac%25.msg,line=2,endLine=2,col=1,endColumn=2,title=ifgen r"
        "::100%25%0Asure%0Ahelp: ok",
        "::error file=demo_msgs/msg/Pose.msg,line=4,endLine=4,col=9,endColumn=10,title=ifgen duplicate-field"
        "::field 'x' is declared twice%0Ademo_msgs/msg/Pose.msg:2: first declared here%0Ahelp: rename one of them",
    ]

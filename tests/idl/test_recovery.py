"""An .idl file with wrong syntax: each mistake is told, and the rest is there for who writes it."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.definition import build
from ifgen.definition.interfaces import Message
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source
from ifgen.idl.omg_parser import parse_idl

LINES = (
    "module demo_msgs {",
    "  module msg {",
    "    struct Demo {",
    "      double a;",
    "      double b",
    "      @unit(value=",
    "      sequence<double, 3> c;",
    "      long d = 5;",
    "      long e;",
    "    };",
    "  };",
    "};",
)


def read(text: str) -> tuple[list[str], list[str]]:
    """The lines with mistakes and the names of the fields that are left."""
    source = Source(Path("Demo.idl"), text)
    problems = FileProblems(source)
    message = build.interface(source, "demo_msgs", "msg", "Demo", problems)
    assert isinstance(message, Message)
    lines = [text.splitlines()[e.primary.span.line - 1].strip() for e in problems.errors() if e.primary]
    return lines, [field.name for field in message.fields]


def test_each_mistake_is_told_and_the_rest_is_there() -> None:
    mistakes, fields = read("\n".join(LINES))
    assert mistakes == ["double b", "sequence<double, 3> c;", "long d = 5;"]
    assert fields == ["a", "b", "e"]


def test_a_semicolon_that_is_missing_costs_no_field() -> None:
    mistakes, fields = read("\n".join(line for line in LINES if "@unit" not in line and "= 5" not in line))
    assert len(mistakes) == 1
    assert fields == ["a", "b", "c", "e"]


def test_a_definition_goes_as_a_whole() -> None:
    text = "module demo_msgs { module msg { union X { long a; }; struct Demo { long b; }; }; };"
    _, fields = read(text)
    assert fields == ["b"]


def test_one_mistake_is_told_once() -> None:
    for text in (
        "}",
        "modul demo_msgs { struct Demo { long a; }; };",
        "struct Demo { long a;",
        "/* x",
        "@@@",
    ):
        assert len(parse_idl(Source(Path("Demo.idl"), text)).problems) == 1


@settings(max_examples=150)
@given(
    st.lists(st.sampled_from([*LINES, "{", "}", ";", '"', "'", "/*", "//", "é", "\0", "struct"]), max_size=14)
)
def test_whatever_stands_there(lines: list[str]) -> None:
    text = "\n".join(lines)
    source = Source(Path("Demo.idl"), text)
    problems = FileProblems(source)
    build.interface(source, "demo_msgs", "msg", "Demo", problems)
    for problem in problems.errors():
        assert problem.primary is not None
        assert 0 <= problem.primary.span.start <= problem.primary.span.end <= len(text) + 1

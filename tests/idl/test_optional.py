"""`@optional`, as rosidl 5.2 reads it: only at the start of a line, for the definition after it."""

from __future__ import annotations

from pathlib import Path

import pytest
from ifgen.diagnostics import Source
from ifgen.idl.parser import parse_message, parse_service
from ifgen.idl.tree import FieldNode, InterfaceTree


def tree(text: str) -> InterfaceTree:
    return parse_message(Source(Path("Demo.msg"), text))


def read(text: str) -> list[tuple[str, bool | None, list[str]]]:
    """Name, whether it is optional, and comments of each definition."""
    found = tree(text)
    assert found.problems == ()
    return [
        (node.name, node.optional if isinstance(node, FieldNode) else None, list(node.comments))
        for node in found.parts[0].definitions
    ]


def test_on_the_line_of_a_field_or_above() -> None:
    text = "@optional float64 a 1.5 # one\nint8 b\n# two\n@optional\t# three\n\n# four\nint8[] c\n"
    assert read(text) == [("a", True, [" one"]), ("b", False, []), ("c", True, [" two", " three", " four"])]
    (part,) = tree(text).parts
    assert [text[start : start + 9] for start in part.optionals] == ["@optional"] * 2


@pytest.mark.parametrize("line_break", ["\n", "\r\n", "\u2028"])
def test_line_breaks(line_break: str) -> None:
    assert read(line_break.join(["@optional", "int8 a", "@optional int8 b", ""])) == [
        ("a", True, []),
        ("b", True, []),
    ]


def test_elsewhere_it_is_text() -> None:
    assert read('string a "@optional"\nstring B=@optional\nint8 c # @optional\n') == [
        ("a", False, []),
        ("B", None, []),
        ("c", False, [" @optional"]),
    ]


def test_what_follows_needs_no_space() -> None:
    """As rosidl cuts the annotation off, it needs no space after it."""
    assert read("@optionalint8 a\n") == [("a", True, [])]


def test_of_a_constant_and_of_nothing() -> None:
    """The annotation of a constant is not reported by rosidl, and one of nothing is ignored."""
    assert read("@optional int8 A=1\n@optional\n") == [("A", None, [])]


def test_in_a_service_it_ends_with_its_part() -> None:
    found = parse_service(Source(Path("Demo.srv"), "@optional\n---\nint8 a\n"))
    assert found.problems == ()
    (node,) = found.parts[1].definitions
    assert isinstance(node, FieldNode)
    assert not node.optional


@pytest.mark.parametrize(
    ("text", "rule", "start"),
    [
        ("@optional\n# again\n@optional int8 a\n", "optional-field", 18),
        ("@optional @optional int8 a\n", "optional-field", 10),
        ("@optional int8\n", "missing-name", 10),
    ],
)
def test_what_is_refused(text: str, rule: str, start: int) -> None:
    (problem,) = tree(text).problems
    assert problem.rule == rule
    assert problem.primary is not None
    assert problem.primary.span.start == start


def test_no_separator_after_it() -> None:
    """It counts as a type without a name, as for rosidl."""
    (part,) = tree("@optional ---\n").parts
    assert [node.type_text for node in part.definitions] == ["@optional"]

"""The tree of a file: its elements, and exactly where they are written."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from ifgen import resources
from ifgen.definition import build
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import MAX_PROBLEMS, Source, Span
from ifgen.idl import parser
from ifgen.idl.parser import MAX_DEFINITIONS, parse_action, parse_message, parse_service
from ifgen.idl.tree import ConstantNode, FieldNode


def source(text: str) -> Source:
    """A message's source."""
    return Source(Path("Demo.msg"), text)


@pytest.mark.parametrize("line_break", ["\n", "\r\n", "\r", "\v", "\f", "\x1c", "\x85", "\u2028"])
def test_offsets_point_at_the_words(line_break: str) -> None:
    """Type, name and value are where the tree says, after any line break, tab or non-ASCII character."""
    text = line_break.join(
        ["# ä\t😀", "uint8[<=3]\t  numbers  [1, 2] \t# the [m]", "string NAME =  'x y' # é", ""]
    )
    (part,) = parse_message(source(text)).parts
    field, constant = part.definitions
    for node in (field, constant):
        assert text[node.type_start :].startswith(node.type_text)
        assert text[node.name_start :].startswith(node.name)
        assert node.value is not None and text[node.value_start :].startswith(node.value)
    assert isinstance(field, FieldNode)
    assert field[::2] == ("uint8[<=3]", "numbers", "[1, 2]", [" the [m]"])
    assert isinstance(constant, ConstantNode)
    assert constant[::2] == ("string", "NAME", "'x y'", [" é"])
    assert part.comments == [" ä 😀"]


@pytest.mark.parametrize(
    "text", ["uint8 a\n---\nuint8 b", "uint8 a\r\n---\r\nuint8 b\r\n", "uint8 a\r---\ruint8 b"]
)
def test_parts(text: str) -> None:
    """A separator divides a file, whatever its line breaks and with or without a last one."""
    tree = parse_service(source(text))
    assert not tree.problems
    assert [[node.name for node in part.definitions] for part in tree.parts] == [["a"], ["b"]]


@pytest.mark.parametrize(
    "text", ["", "\n", "# only a comment", "#", "---\n---", "---\n---\n", "\n---\n\n---\n# x\n"]
)
def test_empty_parts(text: str) -> None:
    """Files and parts without definitions are fine."""
    parse = parse_action if "---" in text else parse_message
    tree = parse(source(text))
    assert not tree.problems
    assert all(not part.definitions for part in tree.parts)


def test_positions_count_from_one() -> None:
    """Lines and columns of a span are the same as in editors."""
    at = Span(source("a\r\nb\u2028cd\n"), 7, 8)
    assert (at.line, at.column) == (3, 3)
    assert at.source.line(3) == "cd"


GARBAGE = {
    "one long word": "x" * 1_000_000,
    "one long line": "uint8 " + "a " * 500_000 + "=",
    "spaces": " " * 1_000_000 + "x",
    "line breaks": "\n" * 1_000_000,
    "short bad lines": "a\n" * 500_000,
    "definitions of nothing": "a b\n" * 250_000,
    "duplicates": "uint8 a\n" * 125_000,
    "separators": "---\n" * 250_000,
    "brackets in a comment": "uint8 a # " + "[" * 1_000_000,
    "backslashes in a comment": "uint8 a # " + "\\" * 1_000_000,
    "backslashes in a string": 'string a "' + "\\" * 1_000_000 + '"',
    "quotes": "string a " + '"' * 1_000_001,
    "escaped quotes in an array": "string[] a [" + '"\\"' * 330_000 + "]",
    "a long constant name": "uint8 " + "A" * 1_000_000 + "_=1",
    "a long field name": "uint8 " + "aB" * 500_000,
    "many dimensions": "uint8" + "[3]" * 330_000 + " a",
    "digits": "uint8 a " + "1" * 1_000_000,
    "NUL": "\0" * 1_000_000,
    "other line breaks": "a\u2028" * 500_000,
}


@pytest.mark.parametrize("kind", ["msg", pytest.param("srv", marks=pytest.mark.slow)])
@pytest.mark.parametrize("text", [pytest.param(text, id=name) for name, text in GARBAGE.items()])
def test_garbage_is_refused_in_linear_time(text: str, kind: str) -> None:
    """A megabyte of any text takes less than a second, with a short report."""
    started = time.process_time()
    problems = FileProblems(Source(Path(f"Demo.{kind}"), text))
    build.interface(Source(Path(f"Demo.{kind}"), text), "demo_msgs", kind, "Demo", problems)  # type: ignore[arg-type]
    found = problems.errors()
    assert time.process_time() - started < 2, "twice what is promised, for slow machines"
    assert found or kind == "msg"
    assert len(found) <= MAX_PROBLEMS + 3
    assert all(len(problem.message) + len(problem.help or "") < 400 for problem in found)


def test_every_bad_line_counts() -> None:
    """The first bad lines are explained, the rest are counted."""
    text = "uint8\n" * 100 + "uint8 a\n"
    problems = FileProblems(source(text))
    build.interface(source(text), "demo_msgs", "msg", "Demo", problems)
    *explained, more = problems.errors()
    assert [problem.primary.span.line for problem in explained if problem.primary] == [
        *range(1, MAX_PROBLEMS + 1)
    ]
    assert (more.rule, more.message) == ("more-errors", "and 80 more errors in this file")


def test_as_many_definitions_as_anyone_needs() -> None:
    """The limit on definitions refuses files that are not interfaces, and the error says where it stopped."""
    nothing = "    # c\n\t \n"
    assert not parse_message(source("uint8 a\n" + nothing * MAX_DEFINITIONS)).problems
    text = "".join(f"uint8 a{number}\n" for number in range(MAX_DEFINITIONS + 1))
    assert not parse_message(source(text.rsplit("\n", 2)[0])).problems
    (problem,) = parse_message(source(text)).problems
    assert problem.rule == "too-many-definitions"
    assert problem.primary is not None and problem.primary.span.line == MAX_DEFINITIONS + 1


@pytest.mark.parametrize("state", ["absent", "kept", "cut short", "of another grammar", "not to be written"])
def test_tables_are_kept_where_that_can_be(
    state: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever happens to the file with lark's tables, the parser is the same."""
    folder = tmp_path / "ifgen"
    monkeypatch.setattr(resources, "cache_folder", lambda: folder)
    make = parser._parser.__wrapped__
    text = "# one\nint32 x 5\nuint8 Y=1\n---\n???\n"
    expected = make()(text)
    [tables] = folder.iterdir()
    if state == "absent":
        tables.unlink()
    elif state == "cut short":
        tables.write_bytes(tables.read_bytes()[:-100])
    elif state == "of another grammar":
        tables.write_bytes(tables.read_bytes()[1:])
    elif state == "not to be written":
        tables.unlink()
        folder.rmdir()
        folder.touch()
    again = make()(text)
    assert again.parts == expected.parts
    assert [line[:2] for line in again.refused] == [line[:2] for line in expected.refused]
    if folder.is_dir():
        written = tables.stat().st_mtime_ns
        assert make()(text).parts == expected.parts
        assert tables.stat().st_mtime_ns == written

"""The trees of .idl files: places, names that are keywords, and hostile input."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.definition import build
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import MAX_PROBLEMS, Source
from ifgen.idl.omg_parser import parse_idl
from ifgen.idl.omg_tree import (
    BasicNode,
    MemberNode,
    ModuleNode,
    PathNode,
    SequenceNode,
    StringNode,
    StructNode,
)
from ifgen.idl.parser import MAX_DEFINITIONS


def members(text: str) -> list[MemberNode]:
    """The members of a struct."""
    tree = parse_idl(Source(Path("Demo.idl"), f"struct Demo {{ {text} }};"))
    assert tree.problems == ()
    (struct,) = tree.definitions
    assert isinstance(struct, StructNode)
    return list(struct.members)


def test_places() -> None:
    """Every element knows its place, with or without comments and line breaks in between."""
    text = "module a { struct B { @x (y=-1.5) /* c */ sequence < string<5>\n, 3 > c // d\n, e[2]; }; };"
    (module,) = parse_idl(Source(Path("Demo.idl"), text)).definitions
    assert isinstance(module, ModuleNode) and text[module.start :].startswith("a {")
    (struct,) = module.definitions
    assert isinstance(struct, StructNode) and text[struct.start :].startswith("B {")
    (member,) = struct.members
    (annotation,) = member.annotations
    assert text[annotation.start : annotation.end] == "@x"
    value = annotation.parameters[0].value
    assert (text[value.start : value.end], value.sign, value.parts) == ("-1.5", "-", ["1.5"])
    type_ = member.type
    assert isinstance(type_, SequenceNode) and isinstance(type_.element, StringNode)
    assert text[type_.start : type_.end] == "sequence < string<5>\n, 3 >"
    assert text[type_.element.start : type_.element.end] == "string<5>"
    first, second = member.declarators
    assert (text[first.start], text[second.start], second.sizes[0].parts) == ("c", "e", ["2"])


def test_keywords_are_keywords_only_where_they_are() -> None:
    """Any keyword can be a member's name, and a name may begin with one."""
    names = ["module", "struct", "const", "string", "sequence", "TRUE", "octet", "longer", "int8_t", "union"]
    found = members("".join(f"long long {name};" for name in names))
    assert [member.declarators[0].name for member in found] == names
    assert {member.type for member in found} == {
        BasicNode("long long", m.type.start, m.type.end) for m in found
    }
    (member,) = members("module::struct::Const enum;")
    assert isinstance(member.type, PathNode) and member.type.text == "module::struct::Const"


GARBAGE = {
    "braces": "{" * 200_000,
    "modules": "module a {" * 20_000,
    "modules that end": "module a { module b {" * 6_000 + "const long X = 1;" + "};};" * 6_000,
    "members": "struct Demo {" + "long a;" * 20_000 + "};",
    "annotations": "struct Demo {" + "@a" * 80_000 + " long x; };",
    "declarators": "struct Demo { long " + "a, " * 60_000 + "b; };",
    "sizes": "struct Demo { long a" + "[1]" * 60_000 + "; };",
    "paths": "struct Demo { " + "a::" * 60_000 + "b c; };",
    "sequences": "struct Demo { " + "sequence<" * 20_000 + "long" + ">" * 20_000 + " a; };",
    "strings": 'struct Demo { @a("x" ' + '"y"' * 40_000 + ") long x; };",
    "an open string": 'struct Demo { @a("' + "x" * 200_000,
    "escapes": 'struct Demo { @a("' + "\\" * 200_001 + '") long x; };',
    "an open comment": "/*" + "*" * 200_000,
    "comments": "/* */" * 40_000,
    "slashes": "/" * 200_000,
    "a long name": "struct " + "a" * 200_000 + " { long x; };",
    "digits": "struct Demo { long a[" + "1" * 200_000 + "]; };",
    "digits of a value": "struct Demo { @default (value=" + "1" * 200_000 + ") long a; };",
    "a tuple": 'struct Demo { @default (value="' + "(" * 20_000 + '") sequence<long> a; };',
    "lost constants": "module a {" + "const long X = 1;" * 10_000 + "};",
    "equal modules": "module a { const long X = 1; };" * 6_000,
    "enums": "enum E { A };" * 10_000,
    "NUL": "\0" * 200_000,
    "spaces": " " * 200_000,
}


# Of lark's tokens, of problems, of depth and of long words; the others are much like one of these.
TYPICAL = {
    "braces",
    "declarators",
    "sequences",
    "an open string",
    "comments",
    "a long name",
    "digits",
    "enums",
}


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(text, id=name, marks=[] if name in TYPICAL else [pytest.mark.slow])
        for name, text in GARBAGE.items()
    ],
)
def test_garbage_is_read_in_linear_time(text: str) -> None:
    """Any garbage is read soon, without an exception, and with a short report."""
    started = time.process_time()
    source = Source(Path("Demo.idl"), text)
    problems = FileProblems(source)
    build.interface(source, "demo_msgs", "msg", "Demo", problems)
    found = problems.errors()
    problems.warnings()
    # lark takes some ten microseconds per token; if anything were quadratic, this would take a minute.
    assert time.process_time() - started < 8
    assert len(found) <= MAX_PROBLEMS + 1
    assert all(len(problem.message) + len(problem.help or "") < 400 for problem in found)


def test_as_many_definitions_as_anyone_needs() -> None:
    """The limit on definitions is the same as for other files, and the error says where it is reached."""
    text = "struct Demo {\n" + "".join(f"long a{n};\n" for n in range(MAX_DEFINITIONS + 1)) + "};"
    problems = FileProblems(Source(Path("Demo.idl"), text))
    build.interface(Source(Path("Demo.idl"), text), "demo_msgs", "msg", "Demo", problems)
    (problem,) = problems.errors()
    assert problem.rule == "too-many-definitions"
    assert problem.primary is not None and problem.primary.span.line == MAX_DEFINITIONS + 2


WORDS = [
    "module",
    "struct",
    "const",
    "typedef",
    "enum",
    "union",
    "sequence",
    "string",
    "wstring",
    "long",
    "double",
    "char",
    "wchar",
    "octet",
    "fixed",
    "unsigned",
    "demo_msgs",
    "msg",
    "Demo",
    "Demo_Constants",
    "TRUE",
    "FALSE",
    "a",
    "b",
    "0",
    "1",
    "07",
    "0x1F",
    "1.5",
    "1e400",
    ".5d",
    "{",
    "}",
    "{",
    "}",
    ";",
    ";",
    ",",
    "::",
    "<",
    ">",
    "[",
    "]",
    "(",
    ")",
    "@",
    "=",
    "-",
    "~",
    "+",
    "/",
    '"x"',
    '"(1,',
    '2)"',
    'L"\\u00e9"',
    '"\\x"',
    "'a'",
    "//",
    "/*",
    "*/",
    "#",
    "#include",
    "default",
    "value",
    "unit",
    "verbatim",
    "key",
    "é",
    "\\",
    '"',
]
pieces = st.sampled_from(
    [*WORDS, " ", "\n", "module demo_msgs { module msg { struct Demo { ", "long a; ", "}; }; };"]
)


@settings(max_examples=500)
@given(
    kind=st.sampled_from(["msg", "srv", "action"]),
    text=st.one_of(st.text(max_size=100), st.lists(pieces, max_size=40).map(" ".join)),
)
def test_any_text(kind: str, text: str) -> None:
    """Any text becomes an interface or errors, and each error is about a place in the text."""
    source = Source(Path("Demo.idl"), text)
    problems = FileProblems(source)
    build.interface(source, "demo_msgs", kind, "Demo", problems)  # type: ignore[arg-type]
    for diagnostic in [*problems.errors(), *problems.warnings()]:
        for label in (diagnostic.primary, *diagnostic.secondary):
            if label is not None:
                assert 0 <= label.span.start <= label.span.end <= len(text)
        assert "\n" not in diagnostic.message

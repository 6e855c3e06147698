"""Inputs that nobody thought of: lines put together at random, and real files with a few characters changed.

rosidl_adapter alone is fast enough for hundreds of them. If its answer differs from ours, the conversion to .idl
and back decides: it resolves the escapes of strings, and refuses inputs that the text stage accepts.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from .conftest import Ours, Reference, Refused, comparable

SHARE = Path(sys.prefix) / "share"
REAL = sorted(path for kind in ("msg", "srv", "action") for path in SHARE.glob(f"*/{kind}/*.{kind}"))

quietly = settings(phases=[Phase.explicit, Phase.generate])


def one_of(text: str) -> st.SearchStrategy[str]:
    """One of the words of a text."""
    return st.sampled_from(text.split())


bases = one_of(
    "bool byte char int8 uint8 int64 uint64 float32 float64 string wstring string<=3 wstring<=12 time Pose "
    "std_msgs/Header pkg/Foo_Request foo Foo_Bar int"
)
suffixes = st.sampled_from(["", "", "", "[]", "[2]", "[<=3]", "[0]", "[ 2]", "]", "[<=+1]", "[1_0]"])
names = one_of("a b a_b a1 a_ _a A B A_B AB1 A__B A_ a__b x-y é from")
atoms = st.one_of(
    one_of("1 0 -1 255 256 1.5 1e3 0x1F 010 1_0 true False nan a abc é ,"),
    one_of(r"""  "" "a" 'a' "a' "a\"b" "\\" \t \n \x41 " ' [ ] #  """),
    st.sampled_from([" ", '"a b"']),
)
values = st.one_of(
    atoms,
    st.lists(atoms, max_size=4).map(lambda items: f"[{', '.join(items)}]"),
    st.lists(atoms, max_size=5).map("".join),
)
spaces = st.sampled_from([" ", " ", " ", "  ", "\t", " \xa0", "\xa0"])
comments = st.sampled_from(
    [
        "",
        "",
        "",
        " # text",
        "#",
        "  # [m]",
        " # a [m] b [s]",
        " # \\q",
        " # \\U",
        " # a[0]",
        " ## x # y",
        " # é \u2028x",
    ]
)
# Most random lines are refused, and one bad line hides what the others mean. So half of the lines are these.
numbers = {
    "bool": ["true", "FALSE", "1"],
    "int8": ["-128", "127", "0x7F", "+5", "0b1", "010"],
    "uint8": ["0", "255", "1_0"],
    "byte": ["0", "255"],
    "char": ["65"],
    "uint64": ["18446744073709551615"],
    "float32": ["1", ".5", "-1e-3", "1e300", "1_0.5"],
    "float64": ["0.1", "-0.0", "1e22"],
}
words = st.lists(
    st.sampled_from(["a", " ", "b c", "é", '\\"', "\\\\", "\\t", "\\", ",", "'", "[0]"]), max_size=4
).map("".join)
strings = st.one_of(words, words.map(lambda word: f'"{word}"'), words.map(lambda word: f"'{word}'"))


def arrays(elements: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """An array of elements, with the separators that occur in files."""
    separators = st.sampled_from([", ", ",", " , ", " "])
    return st.builds(
        lambda items, comma: f"[{comma.join(items)}]", st.lists(elements, max_size=3), separators
    )


def good_lines(base: str) -> st.SearchStrategy[str]:
    """Definitions of a type that are probably accepted."""
    elements = st.sampled_from(numbers[base]) if base in numbers else strings
    number = st.integers(0, 99)
    return st.one_of(
        st.builds(
            lambda n, suffix: f"{base}{suffix} a{n}", number, st.sampled_from(["", "[]", "[3]", "[<=2]"])
        ),
        st.builds(lambda n, value: f"{base} a{n} {value}", number, elements),
        st.builds(lambda n, value: f"{base}[] a{n} {value}", number, arrays(elements)),
        st.builds(lambda n, value: f"{base.partition('<')[0]} A{n}={value}", number, elements),
    )


lines = st.one_of(
    st.sampled_from([*numbers, "string", "wstring", "string<=3"]).flatmap(good_lines),
    st.sampled_from(
        ["Pose a", "std_msgs/Header b", "pkg/Foo_Request[<=2] c", "", " ", "# comment", "  # more", "#   x"]
    ),
    st.builds(lambda base, suffix, space, name: base + suffix + space + name, bases, suffixes, spaces, names),
    st.builds(
        lambda base, suffix, space, name, value: f"{base}{suffix}{space}{name} {value}",
        bases,
        suffixes,
        spaces,
        names,
        values,
    ),
    st.builds(
        lambda base, space, name, equals, value: base + space + name + equals + value,
        bases,
        spaces,
        names,
        st.sampled_from(["=", " = ", "  =", "= "]),
        values,
    ),
    st.sampled_from(["---", "--- ", "uint8", " uint8 a", "\f"]),
)
good_text = st.lists(
    st.one_of(
        st.sampled_from([*numbers, "string", "wstring", "string<=3"]).flatmap(good_lines),
        st.sampled_from(["", "# comment", "  # more", "#   indented [s]"]),
    ),
    max_size=5,
)
parts = good_text.map("\n".join)
inputs = st.one_of(
    st.tuples(st.just("msg"), parts),
    st.tuples(st.just("srv"), st.builds("{}\n---\n{}".format, parts, parts)),
    st.tuples(st.just("action"), st.builds("{}\n---\n{}\n---\n{}".format, parts, parts, parts)),
    st.tuples(
        st.sampled_from(["msg", "srv"]),
        st.lists(st.builds(str.__add__, lines, comments), max_size=3).map("\n".join),
    ),
)


@st.composite
def changed_files(draw: st.DrawFn) -> tuple[str, str]:
    """A real file's kind and its text with up to three places changed."""
    path = draw(st.sampled_from(REAL))
    text = path.read_text(encoding="utf-8")
    for _ in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, len(text)))
        end = min(start + draw(st.sampled_from([0, 0, 1, 1, 2, 30])), len(text))
        text = text[:start] + draw(st.one_of(atoms, lines, st.text(max_size=2))) + text[end:]
    return path.suffix[1:], text


def check(kind: str, text: str, ours: Ours, rosidl: Reference) -> None:
    """Compare the answers; the only differences are those of docs/rosidl-differences.md."""
    mine, theirs = ours.answer(kind, text), rosidl.adapter(kind, text)
    if comparable(mine, kind) == comparable(theirs, kind):
        return
    assert not isinstance(theirs, Refused), f"rosidl: {theirs}\nifgen: {mine}"
    theirs = rosidl.full(kind, text)
    if comparable(mine, kind) == comparable(theirs, kind):
        return
    if isinstance(mine, Refused):
        assert "not-finite" in mine.why, f"rosidl: {theirs}\nifgen: {mine}"
        return
    warned = {problem.rule for problem in ours.problems(kind, text).warnings()}
    if isinstance(mine, tuple) and isinstance(theirs, tuple) and "same-constant" in warned:
        assert [part.fields for part in mine] == [part.fields for part in theirs]
        return
    assert warned & {"backslash-in-comment", "bracket-over-lines"}, f"rosidl: {theirs}\nifgen: {mine}"
    without = re.sub(r"#[^\n]*", "#", text)
    assert comparable(ours.answer(kind, without), kind) == comparable(rosidl.full(kind, without), kind)


@settings(quietly, max_examples=50)
@given(given_input=inputs)
def test_lines_at_random(given_input: tuple[str, str], ours: Ours, rosidl: Reference) -> None:
    """Both agree on any lines."""
    check(*given_input, ours, rosidl)


@pytest.mark.slow
@settings(quietly, max_examples=200)
@given(given_input=inputs)
def test_many_lines_at_random(given_input: tuple[str, str], ours: Ours, rosidl: Reference) -> None:
    check(*given_input, ours, rosidl)


@pytest.mark.skipif(not REAL, reason="the wheels' interfaces are not installed")
@settings(quietly, max_examples=100)
@given(changed=changed_files())
def test_changed_files(changed: tuple[str, str], ours: Ours, rosidl: Reference) -> None:
    """Both agree however a real file is changed."""
    check(*changed, ours, rosidl)


@pytest.mark.slow
@pytest.mark.skipif(not REAL, reason="the wheels' interfaces are not installed")
@settings(quietly, max_examples=400)
@given(changed=changed_files())
def test_many_changed_files(changed: tuple[str, str], ours: Ours, rosidl: Reference) -> None:
    check(*changed, ours, rosidl)


@settings(quietly, max_examples=60)
@given(text=st.lists(st.builds(str.__add__, lines, comments), max_size=2).map("\n".join))
def test_lines_at_random_through_idl(text: str, ours: Ours, rosidl: Reference) -> None:
    """The same with every input converted to .idl and back."""
    mine, theirs = ours.answer("msg", text), rosidl.full("msg", text)
    if comparable(mine, "msg") != comparable(theirs, "msg"):
        check("msg", text, ours, rosidl)


@settings(quietly, max_examples=1000)
@given(name=st.text("AB1_a", max_size=10))
def test_constant_names(name: str, rosidl: Reference) -> None:
    """Our linear rule for constant names is equivalent to rosidl's exponential one."""
    from ifgen.definition.names import is_constant_name

    assert is_constant_name(name) == bool(rosidl.constant_pattern.fullmatch(name))

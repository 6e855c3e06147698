"""Texts of .idl files mean the same to ifgen and rosidl, and so do .msg files that are converted to .idl."""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from ifgen import resources
from ifgen.definition.interfaces import Interface, Message
from ifgen.definition.resolve import resolve
from ifgen.definition.type_description import described_types, type_hash
from ifgen.reading.packages import find_packages
from ifgen.reading.search_path import SearchPath

from .conftest import Refused
from .idl_reference import framed, ours, parts_of, rosidl
from .idl_texts import files

pytestmark = pytest.mark.usefixtures("rosidl")

PAGE = Path(__file__).parents[2] / "docs" / "rosidl-differences.md"
DOCUMENTED = set(re.findall(r"^\| idl-.*?error\[([\w-]+)\]", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
quietly = settings(phases=[Phase.explicit, Phase.generate])


def _sections() -> Iterator[tuple[str, Any, list[str]]]:
    text = Path(__file__).with_name("idl_inputs.txt").read_text(encoding="utf-8")
    for section in text.split("\n== ")[1:]:
        title, *lines = section.split("\n")
        name, _, kind = title.partition(": ")
        yield name, kind, [line.replace("⏎", "\n") for line in lines if line]


@pytest.mark.parametrize(
    ("kind", "inputs"), [pytest.param(kind, inputs, id=name) for name, kind, inputs in _sections()]
)
def test_same_meaning(kind: Any, inputs: list[str]) -> None:
    """The verdicts are the same, and if both accept, so is everything that they read."""
    differences = []
    for text in map(framed, inputs):
        mine, theirs = ours(kind, text)[0], rosidl(kind, text)
        if mine != theirs:
            differences.append(f"{text!r}\n    rosidl {theirs}\n    ifgen  {mine}")
    assert not differences, "\n".join(differences)


def check(kind: Any, text: str, *, mutated: bool = False) -> None:
    """Compare the answers; the only differences are those of docs/rosidl-differences.md."""
    (mine, problems), theirs = ours(kind, text), rosidl(kind, text)
    if mine == theirs:
        return
    shown = f"{text}\nrosidl: {theirs}\nifgen: {mine}"
    assert not isinstance(theirs, Refused), shown
    if isinstance(mine, Refused):
        rules = {problem.rule for problem in problems.errors()}
        # No simple rule tells which words can be joined or be names in random text.
        assert rules & (DOCUMENTED if mutated else DOCUMENTED - {"idl-syntax"}), shown
    else:
        assert "same-constant" in {problem.rule for problem in problems.warnings()}, shown


@settings(quietly, max_examples=40)
@given(drawn=files)
def test_texts_of_rosidls_grammar(drawn: tuple[Any, str]) -> None:
    """Both agree on everything that rosidl_parser's grammar allows."""
    check(*drawn)


@pytest.mark.slow
@settings(quietly, max_examples=400)
@given(drawn=files)
def test_many_texts_of_rosidls_grammar(drawn: tuple[Any, str]) -> None:
    check(*drawn)


MARKS = [
    "{",
    "}",
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
    '"',
    "L",
    "//",
    "/*",
    "*/",
    "#",
]
WORDS = [
    "struct",
    "module",
    "const",
    "long",
    "string",
    "sequence",
    "enum",
    "TRUE",
    "unsigned",
    "0",
    "1.",
    "a",
    "\n",
]


@st.composite
def changed(draw: st.DrawFn) -> tuple[Any, str]:
    """A text of the grammar with up to three places changed."""
    kind, text = draw(files)
    for _ in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, len(text)))
        end = min(start + draw(st.sampled_from([0, 0, 1, 1, 2, 8])), len(text))
        text = text[:start] + draw(st.sampled_from([*MARKS, *WORDS, "", " ", "é"])) + text[end:]
    return kind, text


@settings(quietly, max_examples=30)
@given(drawn=changed())
def test_changed_texts(drawn: tuple[Any, str]) -> None:
    """Both agree however such a text is changed."""
    check(*drawn, mutated=True)


@pytest.mark.slow
@settings(quietly, max_examples=400)
@given(drawn=changed())
def test_many_changed_texts(drawn: tuple[Any, str]) -> None:
    check(*drawn, mutated=True)


@pytest.fixture(scope="module")
def adapted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interfaces that come with ifgen as rosidl_adapter writes them: .idl files only."""
    from rosidl_adapter import convert_to_idl

    root = tmp_path_factory.mktemp("adapted")
    with contextlib.redirect_stdout(io.StringIO()):
        for package in find_packages([resources.bundled_interfaces()]):
            for file in package.files:
                path = file.path.relative_to(package.root)
                convert_to_idl(package.root, package.name, path, root / package.name)
    return root


@pytest.mark.slow
def test_bundled_interfaces_through_idl(adapted: Path) -> None:
    """All interfaces read back from rosidl_adapter's .idl files are the same, with the same hashes."""
    packages, others = find_packages([resources.bundled_interfaces()]), find_packages([adapted])
    registry, other = resolve(packages, SearchPath(packages)), resolve(others, SearchPath(others))
    assert not other.warnings
    hashes = []
    for interface in registry:
        again = other.interface(interface.type_name)
        assert _without_what_is_lost(again) == _without_what_is_lost(interface)
        for one, two in zip(described_types(interface), described_types(again), strict=True):
            assert type_hash(one, registry) == type_hash(two, other)
            hashes.append(one.type_name)
    assert len(list(registry)) >= 257
    assert len(hashes) > len(list(registry))


def _without_what_is_lost(interface: Interface) -> tuple[Message, ...]:
    """The parts of an interface, without units of constants: rosidl_adapter does not write those."""
    return tuple(
        replace(part, constants=tuple(replace(c, unit=None) for c in part.constants))
        for part in parts_of(interface)
    )

"""What `ifgen param dump` writes is what rcl reads, for every value of every type of parameter."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen_runtime.parameters import parameter_yaml
from ifgen_runtime.parameters.parameter_scalars import ParameterVariant
from ifgen_runtime.parameters.parameter_yaml import ParameterYamlError

AWKWARD = [
    "1e5",
    "nan",
    ".nan",
    "inf",
    "-.Inf",
    "y",
    "n",
    "Yes",
    "OFF",
    "null",
    "~",
    "true",
    "2026-01-31",
    "12:30:45",
    "0x1F",
    "0b1",
    "010",
    "007",
    "1_000",
    "-0",
    "+1",
    ".5",
    "5.",
    "1.e3",
    "0x1p3",
    "=",
    "<<",
    "-",
    "?",
    ":",
    "#",
    "*",
    "&",
    "!",
    "|",
    ">",
    "%",
    "@",
    "`",
    "{}",
    "[]",
    "{a:1}",
    "[1]",
    "a:b",
    "<<:",
    "!!str",
    "---",
    "...",
    "''",
    '""',
    "'",
    '"',
    "\\",
    "nan(x)",
    "infinity",
    "+.inf",
]
TEXTS = st.sampled_from(
    [
        *AWKWARD,
        "",
        " ",
        "a: b",
        "a #b",
        "\n",
        "a\nb",
        " a\n  b\n",
        "\t",
        "a\r\n",
        "é",
        "\u2028",
        "\x85",
        "\x7f",
    ]
) | st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=12)
SCALARS: dict[type, st.SearchStrategy[Any]] = {
    bool: st.booleans(),
    int: st.integers(-(2**63), 2**63 - 1),
    float: st.floats() | st.sampled_from([1e5, 1e16, -0.0, 5e-324, 1.7e308, 0.1]),
    str: TEXTS,
}
VALUES = st.one_of(*SCALARS.values(), *(st.lists(each, min_size=1, max_size=4) for each in SCALARS.values()))
BEYOND = st.binary(max_size=4) | st.just([])
PARTS = st.sampled_from(["a", "b", "yes", "1", "ros__parameters", "é", "x y", "~", "null"])
NAMES = st.lists(PARTS, min_size=1, max_size=4).map(".".join) | st.sampled_from([".a", "a..b", "c."])


def bits(value: Any) -> Any:
    """A value whose floats are compared bit by bit, except that every NaN is one, and whose types count."""
    if isinstance(value, list):
        return [bits(each) for each in value]
    if isinstance(value, float):
        return "nan" if math.isnan(value) else struct.pack("d", value)
    return type(value).__name__, value


def read(path: Path, *, everything: bool = False) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, ParameterVariant]] = {}
    parameter_yaml.read_file(str(path), lambda node: found.setdefault(node, {}), everything=everything)
    return {node: {name: each.value() for name, each in entry.items()} for node, entry in found.items()}


@given(VALUES)
def test_a_value_is_read_as_it_was_written(value: Any) -> None:
    """`ifgen param set` and `-p` take the text that a value has in a dump."""
    text = parameter_yaml.value_text(value)
    assert "\n" not in text
    assert bits(parameter_yaml.value_of(text)) == bits(value)


@given(st.dictionaries(NAMES, VALUES | BEYOND, min_size=1, max_size=6))
def test_a_file_is_read_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory, values: Mapping[str, Any]
) -> None:
    """Names within each other, too. What no file can hold is a comment, which only `load` reads."""
    file = tmp_path_factory.getbasetemp() / "dumped.yaml"
    file.write_text(parameter_yaml.file_text("/robot/arm", values))
    held = {name: bits(value) for name, value in values.items() if not parameter_yaml.is_beyond_files(value)}
    found = read(file).get("/robot/arm", {})
    assert {name: bits(value) for name, value in found.items()} == held
    loaded = read(file, everything=True)["/robot/arm"]
    beyond = {name: list(value) or None for name, value in values.items() if name not in held}
    assert {name: loaded[name] for name in beyond} == beyond
    assert {name: bits(loaded[name]) for name in held} == held


def test_a_list_that_is_used_twice(tmp_path: Path) -> None:
    """PyYAML would write an alias, which rcl refuses."""
    gains = [0.1, 2.5]
    (tmp_path / "p.yaml").write_text(parameter_yaml.file_text("/n", {"a": gains, "b": gains}))
    assert read(tmp_path / "p.yaml") == {"/n": {"a": gains, "b": gains}}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a: b", "this is a map"),
        ("{}", "this is a map"),
        ("[1, a]", "the elements of a list have one type"),
        ("[1, 0.1]", "the elements of a list have one type"),
        ("*a", "aliases are not read"),
        ("[" * 2000, "no YAML"),
        ("'a", "it is no YAML: found unexpected end of stream at line 1, column 3"),
        ("a: b: c", "this is a map"),
        ("\ud800", "it is no YAML"),
        ("\x01", "it is no YAML"),
    ],
)
def test_values_that_no_parameter_holds(text: str, reason: str) -> None:
    with pytest.raises(ParameterYamlError) as caught:
        parameter_yaml.value_of(text)
    assert reason in caught.value.reason

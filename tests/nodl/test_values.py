"""Values of parameters in NoDL documents are those of parameter files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source
from ifgen.nodl import values
from ifgen.nodl.syntax import reader, scalars
from ifgen.nodl.values import BadValue
from ifgen_runtime.parameters import parameter_scalars, parameter_yaml

from tests.runtime.test_parameter_yaml import AWKWARD, VALUES, bits

TYPES = {bool: "bool", int: "int", float: "double", str: "string"}


def read(text: str, type_: str) -> Any:
    """The value that a document gives to a parameter of a type."""
    source = Source(Path("a.nodl.yaml"), f"{{value: {text}}}\n")
    node = reader.parse(source, FileProblems(source))
    wanted = values.parameter_type(type_)
    assert node is not None
    assert wanted is not None
    return values.value(node.entries[0][1], wanted)  # type: ignore[union-attr]


# Pieces of what C reads as numbers, and of words that mean something to somebody.
PIECES = [
    "0",
    "1",
    "7",
    "9",
    "308",
    "1074",
    "9223372036854775808",
    "0x",
    "0X",
    "ff",
    "A",
    ".",
    "e",
    "E",
    "p",
    "P",
    "+",
    "-",
]
WORDS = ["inf", "Infinity", "nan", "NAN", "(x)", "y", "No", "ON", "True", "~", "null", "_", ":"]
NUMBERS = st.lists(st.sampled_from([*PIECES, *WORDS]), max_size=7).map("".join)


@given(
    NUMBERS
    | st.sampled_from(AWKWARD)
    | st.text(max_size=5)
    | st.floats().map(repr)
    | st.floats().map(float.hex)
)
@settings(max_examples=500)
def test_two_readers_of_scalars_are_one(text: str) -> None:
    """Ifgen and ifgen_runtime must not import each other, so each has its own.

    tests/against_rclpy/test_parameter_files.py compares that of ifgen_runtime with rcl.
    """
    assert bits(scalars.read_scalar(text)) == bits(parameter_scalars.read_scalar(text))


@given(VALUES)
def test_what_a_dump_writes(value: Any) -> None:
    kind = TYPES[type(value[0] if isinstance(value, list) else value)]
    found = read(parameter_yaml.value_text(value), f"{kind}_array" if isinstance(value, list) else kind)
    assert bits(list(found) if isinstance(value, list) else found) == bits(value)


@pytest.mark.parametrize(
    "text", [each for each in AWKWARD if each.isascii() and each.strip("-?:#*&!|>%@`{}[]<'\"")]
)
def test_what_people_write(text: str) -> None:
    """A document and a parameter file that both take a value agree, except where only the type makes it a text."""
    try:
        value = parameter_yaml.value_of(text)
    except parameter_yaml.ParameterYamlError:
        return
    found = read(text, TYPES.get(type(value), "int_array"))
    if isinstance(found, BadValue):
        assert text in {"null", "~"}  # people mean nothing by these, and a parameter file a text
    else:
        assert bits(list(found) if isinstance(found, tuple) else found) == bits(value)

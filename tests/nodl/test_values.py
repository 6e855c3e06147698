"""Values of parameters in NoDL documents are those of parameter files."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source
from ifgen.nodl import values
from ifgen.nodl.syntax import parameter_scalars, yaml_text
from ifgen.nodl.values import BadValue
from ifgen_runtime import parameter_scalars as of_runtime
from ifgen_runtime import parameter_yaml

from tests.runtime.test_parameter_yaml import AWKWARD, VALUES, bits

TYPES = {bool: "bool", int: "int", float: "double", str: "string"}


def read(text: str, type_: str) -> Any:
    """The value that a document gives to a parameter of a type."""
    source = Source(Path("a.nodl.yaml"), f"{{value: {text}}}\n")
    node = yaml_text.parse(source, FileProblems(source))
    wanted = values.parameter_type(type_)
    assert node is not None
    assert wanted is not None
    return values.value(node.entries[0][1], wanted)  # type: ignore[union-attr]


def test_two_readers_of_scalars_are_one() -> None:
    """Ifgen and ifgen_runtime must not import each other, so each has its own."""
    ours, theirs = (
        inspect.getsource(module).partition("_TRUE = ")[2] for module in (parameter_scalars, of_runtime)
    )
    assert theirs.startswith(ours)
    assert len(ours) > 1000


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

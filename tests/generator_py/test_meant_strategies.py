"""Hypothesis strategies of generated tests draw what the comments of fields allow, and nothing else."""

from __future__ import annotations

import re
from array import array
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ifgen.definition.build import interface
from ifgen.definition.interfaces import Message, Registry
from ifgen.definition.problems import FileProblems
from ifgen.diagnostics import Source
from ifgen.generator_py.tests.strategies import Strategies


def strategy_of(field: str) -> str:
    """The text of the strategy for a field's values."""
    source = Source(Path("demo_msgs/msg/Demo.msg"), f"uint8 MODE_A=1\nuint8 MODE_B=4\n{field}\n")
    message = interface(source, "demo_msgs", "msg", "Demo", FileProblems(source))
    assert isinstance(message, Message)
    strategies = Strategies(Registry.of_interfaces([message]))
    strategies.message(message)
    ((_, text),) = strategies.messages
    return text.partition("x=")[2].strip().rstrip(")").rstrip(",\n") + (")" if "(" in text else "")


@pytest.mark.parametrize(
    ("field", "strategy"),
    [
        ("uint8 x # [@range 0, 100] [@invalid 255]", "st.integers(0, 100) | st.just(255)"),
        ("uint8 x # [@range -5, 1000]", "st.integers(0, 255)"),
        ("int8 x # [@range 0.5, 2.5]", "st.integers(1, 2)"),
        ("uint8 x # [@enum MODE]", "st.sampled_from([1, 4])"),
        ("uint8 x # [@enum MODE] Flags", "st.sampled_from([1, 4]) | UINT8S"),
        ("float64 x # [@range 0, ]", "st.floats(min_value=0.0, allow_nan=False, allow_infinity=False)"),
        ("float64 x # [@range 0, 1] [@invalid NaN]", "st.floats(min_value=0.0, max_value=1.0, allow_nan=False, allow_infinity=False)"),
    ],
)  # fmt: skip
def test_text(field: str, strategy: str) -> None:
    assert strategy_of(field).startswith(strategy.rstrip(")"))


@given(st.tuples(st.floats(-1e30, 1e30), st.floats(-1e30, 1e30)).map(sorted))
def test_bounds_of_32_bits_are_within(bounds: list[float]) -> None:
    low, high = bounds
    text = strategy_of(f"float32 x # [@range {low!r}, {high!r}]")
    if not text.startswith("st.floats"):
        return  # no float32 lies between them
    least, most = (float(found) for found in re.findall(r"_value=(\S+?)[,)]", text))
    assert low <= least <= most <= high
    assert array("f", [least, most]).tolist() == [least, most]

"""Every input of inputs.txt means the same to ifgen and to rosidl."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from .conftest import Ours, Reference, comparable, decode


def _sections() -> Iterator[tuple[str, str, list[str]]]:
    text = Path(__file__).with_name("inputs.txt").read_text(encoding="utf-8")
    for section in text.split("\n== ")[1:]:
        title, *lines = section.split("\n")
        name, _, kind = title.partition(": ")
        yield name, kind, [decode(line) for line in lines if line]


@pytest.mark.parametrize(
    ("kind", "inputs"), [pytest.param(kind, inputs, id=name) for name, kind, inputs in _sections()]
)
def test_same_meaning(kind: str, inputs: list[str], ours: Ours, rosidl: Reference) -> None:
    """The verdicts are the same, and if both accept, so are types, names, values, comments and units."""
    differences = []
    for text in inputs:
        mine, theirs = ours.answer(kind, text), rosidl.full(kind, text)
        if comparable(mine, kind) != comparable(theirs, kind):
            differences.append(f"{text!r}\n    rosidl {theirs}\n    ifgen  {mine}")
    assert not differences, "\n".join(differences)

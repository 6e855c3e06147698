"""BufferCore: loops, deep trees, and reports of trees."""

from __future__ import annotations

from typing import Any

import pytest
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    LookupException,
)

from tests.libraries.inside.tf2.frames import LATEST, at, buffer_of, edge, x_of


@pytest.mark.parametrize("length", [2, 3, 50])
def test_a_loop_is_found(length: int) -> None:
    names = [f"f{index}" for index in range(length)]
    buffer = buffer_of(
        *(edge(parent, child) for parent, child in zip(names, [*names[1:], names[0]], strict=True)),
        edge("elsewhere", "lost"),
    )
    for time_ in (LATEST, at(1.0)):
        for target, source in (("f0", "lost"), ("lost", "f0")):
            said = refused_loop(buffer, target, source, time_)
            assert said.startswith("The tf tree is invalid because it contains a loop.\nFrame f1 exists with")


def refused_loop(buffer: BufferCore, target: str, source: str, time_: Any) -> str:
    with pytest.raises(LookupException) as caught:
        buffer.lookup_transform_core(target, source, time_)
    assert buffer.can_transform_core(target, source, time_) == (False, str(caught.value))
    return str(caught.value)


def test_deep_trees() -> None:
    buffer = buffer_of(*(edge(f"f{index}", f"f{index + 1}") for index in range(10_000)))
    assert x_of(buffer, "f0", "f1000") == 1000.0
    assert x_of(buffer, "f1000", "f0", at(1.0)) == -1000.0
    for time_ in (LATEST, at(1.0)):  # upstream takes more for a loop
        assert refused_loop(buffer, "f0", "f10000", time_).startswith("The tf tree is invalid")
        assert refused_loop(buffer, "f10000", "f0", time_).startswith("The tf tree is invalid")
    assert len(buffer.all_frames_as_string().splitlines()) == 10_000


def test_reports() -> None:
    buffer = buffer_of(edge("map", "base", 1.0), edge("map", "base", 2.5), edge("map", "base", 2.0))
    buffer.set_transform_static(edge("base", "laser"), "me")
    assert buffer.all_frames_as_string() == (
        "Frame base exists with parent map.\nFrame laser exists with parent base.\n"
    )
    assert buffer.all_frames_as_yaml() == (
        "base: \n  parent: 'map'\n  broadcaster: 'test'\n  rate: 2.000\n  most_recent_transform: 2.500000\n"
        "  oldest_transform: 1.000000\n  buffer_length: 1.500\n"
        "laser: \n  parent: 'base'\n  broadcaster: 'me'\n  rate: 10000.000\n  most_recent_transform: 0.000000\n"
        "  oldest_transform: 0.000000\n  buffer_length: 0.000\n"
    )
    dot = buffer._allFramesAsDot(at(3.0))
    assert dot.startswith(
        'digraph G {\n"map" -> "base"[label="Broadcaster: test\\nAverage rate: 2.000 Hz\\nMost recent transform: '
        '2.500000 ( 0.500 sec old)\\nBuffer length: 1.500 sec\\n"];\n'
    )
    assert dot.endswith('"Recorded at time: 3.000000"[ shape=plaintext ] ;\n }->"map";\n}')
    assert "sec old" not in buffer._allFramesAsDot()
    assert BufferCore()._allFramesAsDot() == 'digraph G {\n"no tf data recieved"}'
    assert buffer._frameExists("map") and not buffer._frameExists("/map")
    assert buffer._getFrameStrings() == ["base", "map", "laser"]


def test_chains() -> None:
    buffer = buffer_of(edge("A", "B"), edge("B", "C"), edge("A", "D"), edge("x", "y"))
    assert buffer._chain("D", at(1.0), "C", at(1.0), "A") == ["C", "B", "A", "D"]
    assert buffer._chain("C", LATEST, "D", LATEST, "B") == ["D", "A", "B", "C"]
    assert buffer._chain("B", LATEST, "C", LATEST, "A") == ["C", "B"]
    assert buffer._chain("C", LATEST, "A", LATEST, "A") == ["A", "B", "C"]
    with pytest.raises(LookupException):
        buffer._chain("D", at(1.0), "none", at(1.0), "A")
    with pytest.raises(ConnectivityException):
        buffer._chain("A", at(1.0), "y", at(1.0), "A")
    with pytest.raises(ExtrapolationException):
        buffer._chain("D", at(2.0), "C", at(2.0), "A")

"""Whatever another node says of its definition, the warning about it is a short text."""

from __future__ import annotations

import copy
import random
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ifgen.cli.evolution.explain import explain

from .definitions import BATTERY, NEW, OLD, made, met

STATE = "robot_msgs/msg/State"
TEXT = "string name\ngeometry_msgs/PoseWithCovariance[<=3] poses\nBatteryState battery\n"
MISMATCH = asdict(met(made(TEXT, STATE, {BATTERY: OLD}), made(TEXT, STATE, {BATTERY: NEW})))
SIDES = ("mine", "theirs")

ODD: list[Any] = [
    *(None, -1, 0, 1, 2**31, 2**64, 10**400, 0.1, float("nan"), "", "a" * 300, "\0", "\x1b[2J", "\ud800"),
    *([], {}, [[]], {"type_name": []}, "robot_msgs/msg/State", "__class__", b"\xff", object()),
]


def _places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The ways to everything in nested dictionaries and lists."""
    keys = value.keys() if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    return [found for key in keys for found in ((*path, key), *_places(value[key], (*path, key)))]


def _change(document: Any, chosen: random.Random) -> None:
    """Put something odd somewhere, or repeat, swap or drop something."""
    *way, last = chosen.choice([place for place in _places(document) if place[0] == "document"])
    holder = document
    for key in way:
        holder = holder[key]
    match chosen.randrange(3):
        case 0:
            holder[last] = chosen.choice(ODD)
        case 1 if isinstance(holder, list):
            holder.insert(chosen.randrange(len(holder) + 1), copy.deepcopy(holder[last]))
        case 1:
            holder[last] = copy.deepcopy(chosen.choice(list(holder.values())))
        case _ if way:
            del holder[last]
        case _:
            holder[last] = None


def _changed_text(text: str, chosen: random.Random) -> str:
    start = chosen.randrange(len(text) + 1)
    piece = chosen.choice(
        ["\n", "\x1b[31m", "\0", "\ud800", "x" * 400, "int8 x\n", "[", "<=", "#", "=", "\u2028", ""]
    )
    return text[:start] + piece * chosen.choice([1, 1, 50]) + text[start + chosen.randrange(9) :]


@pytest.fixture(autouse=True)
def _in_no_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("ifgen.cli.evolution.explain.head", None)  # what an exception would fall back on


@pytest.mark.parametrize("what", ["document", "sources", "hashes"])
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32))
def test_a_definition_that_was_changed(what: str, seed: int) -> None:
    _check(what, seed)


@pytest.mark.slow
@pytest.mark.parametrize("what", ["document", "sources", "hashes"])
@settings(max_examples=1500, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32))
def test_many_definitions_that_were_changed(what: str, seed: int) -> None:
    _check(what, seed)


def _check(what: str, seed: int) -> None:
    chosen = random.Random(seed)
    mismatch = copy.deepcopy(MISMATCH)
    side = mismatch[chosen.choice(SIDES)]
    for _ in range(chosen.randrange(1, 4)):
        if what == "document":
            side["definition"]["sources"] = ()
            _change(side["definition"], chosen)
        elif what == "sources":
            sources = [list(source) for source in side["definition"]["sources"]]
            at = chosen.randrange(len(sources))
            sources[at][chosen.randrange(3)] = chosen.choice(ODD)
            sources[-1 - at][2] = _changed_text(str(sources[-1 - at][2]), chosen)
            side["definition"]["sources"] = sources
        else:
            side[chosen.choice(["type_hash", "node"])] = str(chosen.choice(ODD))
            mismatch["type_name"] = chosen.choice(
                [STATE, BATTERY, "a/b", "", "..", "/", "../../etc/x", "a/msg/B_C_"]
            )
    text = explain(mismatch)
    assert text.startswith("topic '/battery':")
    assert len(text) < 2**16
    assert not any(character in text for character in "\0\x1b\u2028")
    text.encode()

"""Of every single edit of the bundled interfaces, two nodes that have both versions name the right change."""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import ifgen as toolkit
import pytest
from ifgen.definition.described.texts import read_texts
from ifgen.definition.type_description import describe, type_hash
from ifgen.evolution.explaining.explanation import explained

from tests.evolution.corpus import Edit, Line, edits, messages

ROOT = Path(__file__).resolve().parents[3]
NAME = "edited_msgs/msg/Edited"


@pytest.fixture(scope="module")
def every() -> list[Edit]:
    chance = random.Random(14)
    bundled = toolkit.load(ROOT / "interfaces")
    return [edit for message in messages(bundled) for edit in edits(message, chance)]


def test_some_edits(every: list[Edit], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    of_rules: dict[str | None, list[Edit]] = {}
    for edit in every:
        of_rules.setdefault(edit.rule, []).append(edit)
    chance = random.Random(16)
    assert check(edit for found in of_rules.values() for edit in chance.sample(found, 3)) >= 12


@pytest.mark.slow
def test_many_edits(every: list[Edit], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert check(every[::4]) > 2_000


def check(some: Iterable[Edit]) -> int:
    """Explain each edit that changes the hash, from sources and from descriptions; returns how many."""
    count = 0
    for edit in some:
        sides = [side(lines, node) for lines, node in ((edit.after, "/monitor"), (edit.before, "/driver"))]
        if sides[0]["type_hash"] == sides[1]["type_hash"]:
            continue
        count += 1
        for theirs in (sides[1], without_sources(sides[1])):
            found = explained(
                {
                    **{"kind": "topic", "name": "/edited", "type_name": NAME, "policy": "warn"},
                    **{"mine": sides[0], "theirs": theirs},
                }
            )
            rules = [change.rule for change in found.changes]
            assert rules == [edit.rule], (edit, found)
            (change,) = found.changes
            assert change.primary is not None or edit.rule == "field-removed", edit
    return count


def side(lines: Sequence[Line], node: str) -> dict[str, Any]:
    text = "".join(map(str, lines))
    described, registry = read_texts(NAME, [(NAME, "msg", text)])
    definition = {"document": describe(described, registry), "sources": [(NAME, "msg", text)]}
    return {
        **{"node": node, "role": "publisher"},
        **{"type_hash": type_hash(described, registry), "definition": definition},
    }


def without_sources(side: dict[str, Any]) -> dict[str, Any]:
    return {**side, "definition": {**side["definition"], "sources": []}}

"""The text of a warning: of the toolkit where that is installed, else one line."""

from __future__ import annotations

from dataclasses import replace
from importlib.metadata import EntryPoint
from types import SimpleNamespace
from typing import Any

import pytest
from ifgen_runtime.mismatch import reporting
from ifgen_runtime.mismatch.reporting import Definition, Mismatch, Side, explanation, in_one_line

MINE = Side("/monitor", "subscription", "RIHS01_" + "a" * 64, Definition({}))
THEIRS = Side("/driver", "publisher", "RIHS01_" + "b" * 64)
MISMATCH = Mismatch("topic", "/battery", "robot_msgs/msg/BatteryState", "warn", MINE, THEIRS)

LINE = (
    "topic '/battery': /driver (publisher) has another definition of robot_msgs/msg/BatteryState than "
    "/monitor (subscription): RIHS01_bbbbbbbbbbbbbbbb..., not RIHS01_aaaaaaaaaaaaaaaa..."
)


def _installed(monkeypatch: pytest.MonkeyPatch, *found: Any) -> list[str]:
    asked: list[str] = []

    def entry_points(group: str, name: str) -> Any:
        asked.append(f"{group}:{name}")
        return found

    monkeypatch.setattr(reporting, "entry_points", entry_points)
    return asked


def test_the_toolkit_is_installed_here_and_explains() -> None:
    text = explanation(MISMATCH)
    assert text.startswith("topic '/battery': /driver (publisher) has another definition of\nrobot_msgs/msg")
    assert "help: use the same definition in both nodes" in text


def test_without_the_toolkit_it_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = _installed(monkeypatch)
    assert explanation(MISMATCH) == LINE == in_one_line(MISMATCH)
    assert asked == ["ifgen.mismatch:explain"]


@pytest.mark.parametrize("failure", [ImportError("half of it is gone"), RecursionError(), KeyError("mine")])
def test_a_toolkit_that_fails_is_as_none(failure: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    def explain(_: object) -> str:
        raise failure

    _installed(monkeypatch, SimpleNamespace(load=lambda: explain))
    assert explanation(MISMATCH) == LINE
    _installed(monkeypatch, EntryPoint("explain", "no_such_module:explain", "ifgen.mismatch"))
    assert explanation(MISMATCH) == LINE


def test_a_side_without_a_hash_is_told_from_one_with_another(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = _installed(monkeypatch)
    assert explanation(replace(MISMATCH, theirs=replace(THEIRS, type_hash=""))) == (
        "topic '/battery': /driver (publisher) does not say which definition of robot_msgs/msg/BatteryState "
        "it has, as nodes before ROS 2 Iron. Nobody can tell whether it is another one"
    )
    assert not asked  # there is nothing to compare

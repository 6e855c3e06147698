"""Meanings of fields at run time: markers in annotations, and warnings about values outside their ranges."""

from __future__ import annotations

import math
import sys
import typing
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import ifgen
import pytest
from ifgen_runtime.checks import ranges
from ifgen_runtime.meaning import Constants, Deprecated, Frame, Invalid, Range, Unit, meanings

from .support import imported_from

ROOT = Path(__file__).resolve().parents[2]
WHEEL = """\
uint8 MODE_STOP=0
uint8 MODE_DRIVE=1
uint8 mode       # [@enum MODE] What it does
float64 speed    # [m/s] [@range -3, 3] [@frame base_link] [@invalid NaN If "lost"] Speed
float32[3] gains # [-] [@range 0, 1] Gains
uint8 load       # [%] [@range , 100] [@invalid 255] Load
string note      # @deprecated write a log
"""


@pytest.fixture(scope="module")
def messages(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The module of `meant_msgs.msg`, with Wheel and Cart, which has wheels."""
    folder = tmp_path_factory.mktemp("meant")
    source = folder / "meant_msgs/msg"
    source.mkdir(parents=True)
    (source / "Wheel.msg").write_text(WHEEL)
    (source / "Cart.msg").write_text("Wheel front\nWheel[] others\nint8 count\n")
    (source / "Plain.msg").write_text("int8 count  # [@frame map]\n")
    ifgen.generate(source.parent, output=folder / "out", include=[ROOT / "interfaces"])
    with imported_from(folder / "out", ["meant_msgs"]):
        yield __import__("meant_msgs.msg", fromlist=["Wheel"])


def test_markers(messages: Any) -> None:
    assert meanings(messages.Wheel) == {
        "mode": (Constants("MODE"),),
        "speed": (Unit("m/s"), Range(-3, 3), Frame("base_link"), Invalid(math.nan, 'If "lost"')),
        "gains": (Unit("-"), Range(0, 1)),
        "load": (Unit("%"), Range(None, 100), Invalid(255)),
        "note": (Deprecated("write a log"),),
    }
    assert meanings(messages.Cart) == {}


def test_type_hints(messages: Any) -> None:
    assert typing.get_type_hints(messages.Wheel)["speed"] is float
    hint = typing.get_type_hints(messages.Wheel, include_extras=True)["speed"]
    assert hint.__metadata__ == meanings(messages.Wheel)["speed"]


def test_constants_stay_integers(messages: Any) -> None:
    assert (messages.Wheel.MODE_DRIVE, type(messages.Wheel.MODE_DRIVE)) == (1, int)
    assert messages.Wheel.ModeEnum.DRIVE == 1


def test_a_class_made_at_run_time_has_markers() -> None:
    import ifgen.dynamic

    cls = ifgen.dynamic.class_from_text("own_msgs/msg/Wheel", WHEEL)
    assert meanings(cls)["speed"][1] == Range(-3, 3)
    assert meanings(cls)["gains"] == (Unit("-"), Range(0, 1))


class Clock:
    now = 100.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    found = Clock()
    monkeypatch.setattr(ranges, "time", found)
    monkeypatch.setenv(ranges.VARIABLE, "1")
    return found


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"speed": 3.5}, "speed = 3.5, outside -3 to 3 (meant_msgs/msg/Wheel.msg:4)"),
        ({"speed": -math.inf}, "speed = -inf, outside -3 to 3 (meant_msgs/msg/Wheel.msg:4)"),
        ({"gains": [0.0, 1.0, 1.5]}, "gains[2] = 1.5, outside 0 to 1 (meant_msgs/msg/Wheel.msg:5)"),
        ({"load": 101}, "load = 101, above 100 (meant_msgs/msg/Wheel.msg:6)"),
        ({"load": 255, "speed": math.nan}, None),
        ({"speed": 3.0, "gains": [0.0, 1.0, 0.5], "load": 100}, None),
    ],
)
def test_values(messages: Any, clock: Clock, fields: dict[str, Any], said: str | None) -> None:
    lines: list[str] = []
    look = ranges.look_at(messages.Wheel, "/wheel", "published", lines.append)
    assert look is not None
    look(messages.Wheel(**fields))
    assert lines == ([f"topic '/wheel': published meant_msgs/msg/Wheel with {said}"] if said else [])


def test_nested_values_and_the_pace(messages: Any, clock: Clock) -> None:
    lines: list[str] = []
    look = ranges.look_at(messages.Cart, "/cart", "received", lines.append)
    assert look is not None
    cart = messages.Cart(others=[messages.Wheel(), messages.Wheel(load=200)])
    for now in (100.0, 100.4, 100.9, 101.1):
        clock.now = now
        look(cart)
    first = "topic '/cart': received meant_msgs/msg/Cart with others[1].load = 200, above 100 (meant_msgs/msg/Wheel.msg:6)"
    assert lines == [first, f"{first}; 2 more since the last warning"]


def test_nothing_looks_without_ranges_or_the_variable(
    messages: Any, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ranges.look_at(messages.Plain, "/plain", "received", print) is None
    monkeypatch.setenv(ranges.VARIABLE, "0")
    assert ranges.look_at(messages.Wheel, "/wheel", "received", print) is None
    monkeypatch.delenv(ranges.VARIABLE)
    assert ranges.look_at(messages.Wheel, "/wheel", "received", print) is None
    assert "meant_msgs.msg" in sys.modules

"""Paths of fields."""

from __future__ import annotations

from typing import Any

import pytest
from ifgen.command_kit.tool import ToolError
from ifgen.dynamic import class_from_text
from ifgen_tools.texts.formats import selector

CLASS: type[Any] = class_from_text(
    "demo_msgs/msg/Route", "geometry_msgs/Point[] points\nfloat64[3] limits\nfloat64 speed"
)


def test_fields() -> None:
    message = CLASS(limits=[0.1, 0.2, 0.3], speed=1.5)
    assert selector(CLASS, "speed")(message) == 1.5
    assert selector(CLASS, "limits[1]")(message) == 0.2
    with pytest.raises(IndexError):
        selector(CLASS, "points[0].x")(message)


@pytest.mark.parametrize(
    ("path", "expected", "help"),
    [
        ("sped", "demo_msgs/msg/Route has no field 'sped'", "did you mean 'speed'?"),
        ("points[0].w", "geometry_msgs/msg/Point has no field 'w'", "its fields are x, y, z"),
        ("speed.x", "there is nothing inside the field 'speed'", "leave out 'x'"),
        ("speed[0]", "the field 'speed' of demo_msgs/msg/Route is no list", "leave out the [0]"),
        ("a-b", "'a-b' is no path of fields", "write it as pose.position.x, or poses[0].x"),
        (".", "'.' names no field", "demo_msgs/msg/Route has points, limits, speed"),
    ],
)
def test_what_is_wrong_is_named(path: str, expected: str, help: str) -> None:
    with pytest.raises(ToolError) as caught:
        selector(CLASS, path)
    assert (caught.value.message, caught.value.help) == (expected, help)

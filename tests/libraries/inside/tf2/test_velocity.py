"""BufferCore: how fast frames move."""

from __future__ import annotations

import math
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped, Vector3
from rclpy.duration import Duration
from tf2_py import (
    BufferCore,
    LookupException,
)

from tests.libraries.inside.tf2.frames import LATEST, at, buffer_of, edge


def square(x: Any, buffer: BufferCore) -> None:
    """A frame that goes up and down in each axis, a second each way; `x` places it."""
    position = [0.0, 0.0, 0.0]
    buffer.set_transform(x(position, 100.0), "test")
    for step in range(60):
        second = step // 10
        position[second // 2] += 0.1 if second % 2 == 0 else -0.1
        buffer.set_transform(x(position, 100 + (step + 1) / 10), "test")
    buffer.set_transform_static(edge("foo", "beside", x=1.0), "test")


def test_linear_velocity() -> None:
    def place(position: list[float], stamp: float) -> TransformStamped:
        message = edge("foo", "bar", stamp)
        message.transform.translation = Vector3(x=position[0], y=position[1], z=position[2])
        return message

    buffer = BufferCore()
    square(place, buffer)
    for seconds, axis, sign in (
        (0.5, 0, 1),
        (1.5, 0, -1),
        (2.5, 1, 1),
        (3.5, 1, -1),
        (4.5, 2, 1),
        (5.5, 2, -1),
    ):
        for frame in ("foo", "beside"):
            linear, angular = buffer.lookupVelocityCore(
                "bar", frame, at(100 + seconds), Duration(seconds=0.1)
            )
            assert linear == pytest.approx([sign if index == axis else 0 for index in range(3)], abs=1e-6)
            assert angular == pytest.approx((0, 0, 0), abs=1e-6)


def test_angular_velocity() -> None:
    def place(position: list[float], stamp: float) -> TransformStamped:
        half = [value / 2 for value in position]
        rotation = (math.sin(half[0]), math.sin(half[1]), math.sin(half[2]), math.cos(sum(half)))
        return edge("foo", "bar", stamp, x=0.0, rotation=rotation)

    buffer = BufferCore()
    square(place, buffer)
    # Seen from 1 m beside it, what turns about y or z also moves.
    for seconds, angular, linear in (
        (0.5, (1, 0, 0), (0, 0, 0)),
        (1.5, (-1, 0, 0), (0, 0, 0)),
        (2.5, (0, 1, 0), (0, 0, -1)),
        (3.5, (0, -1, 0), (0, 0, 1)),
        (4.5, (0, 0, 1), (0, 1, 0)),
        (5.5, (0, 0, -1), (0, -1, 0)),
    ):
        interval = Duration(seconds=0.1)
        found = buffer.lookupVelocityCore("bar", "foo", at(100 + seconds), interval)
        assert found[0] == pytest.approx((0, 0, 0), abs=1e-6)
        assert found[1] == pytest.approx(angular, abs=1e-6)
        found = buffer.lookupVelocityCore("bar", "beside", at(100 + seconds), interval)
        assert found[0] == pytest.approx(linear, abs=1e-6)
        assert found[1] == pytest.approx(angular, abs=1e-6)


def test_velocity_of_all_that_is_stored() -> None:
    buffer = buffer_of(*(edge("PARENT", "THISFRAME", second, x=second * 3.0) for second in range(5)))
    interval = Duration(seconds=4, nanoseconds=1_000_000)
    simple = buffer.lookupVelocityCore("THISFRAME", "PARENT", LATEST, interval)
    assert simple[0][0] == pytest.approx(3.0, abs=0.01)
    full = buffer.lookupVelocityFullCore(
        "THISFRAME", "PARENT", "PARENT", (0, 0, 0), "THISFRAME", LATEST, interval
    )
    assert full == simple
    with pytest.raises(LookupException):
        buffer.lookupVelocityCore("none", "PARENT", LATEST, interval)

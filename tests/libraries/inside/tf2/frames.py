"""Transforms and buffers for the tests of tf2, which run on either transport."""

from __future__ import annotations

from typing import Any

import pytest
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from rclpy.time import Time
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    TransformException,
)

LATEST = Time()


def at(seconds: float) -> Time:
    return Time(nanoseconds=round(seconds * 1e9))


def edge(
    parent: str,
    child: str,
    stamp: float = 1.0,
    x: float = 1.0,
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0),
) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp = at(stamp).to_msg()
    message.transform.translation = Vector3(x=x, y=0.0, z=0.0)
    message.transform.rotation = Quaternion(x=rotation[0], y=rotation[1], z=rotation[2], w=rotation[3])
    return message


def buffer_of(*edges: TransformStamped, **options: Any) -> BufferCore:
    buffer = BufferCore(**options)
    for message in edges:
        buffer.set_transform(message, "test")
    return buffer


def x_of(buffer: BufferCore, target: str, source: str, time: Any = LATEST) -> float:
    return buffer.lookup_transform_core(target, source, time).transform.translation.x


def refused(kind: type[TransformException], buffer: BufferCore, target: str, source: str, time: Any) -> str:
    """The text of the exception, which can_transform_core says as well."""
    with pytest.raises(TransformException) as caught:
        buffer.lookup_transform_core(target, source, time)
    assert type(caught.value) is kind
    possible, why = buffer.can_transform_core(target, source, time)
    assert not possible and why
    if kind in {ConnectivityException, ExtrapolationException}:
        assert why == str(caught.value)
    return str(caught.value)

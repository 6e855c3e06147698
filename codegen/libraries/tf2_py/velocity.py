"""The velocity of one frame as seen from another."""

from __future__ import annotations

import math
from typing import TypeAlias

from tf2_py.transforms import Transform, Vector, compose, invert, rotate
from tf2_py.tree import FrameTree

# Linear [m/s] and angular [rad/s].
Twist: TypeAlias = tuple[Vector, Vector]

# What upstream leaves between the interval and time 0, which would ask for the latest transform [s].
_MARGIN = 0.00001


def twist_between(
    tree: FrameTree,
    tracking: str,
    observation: str,
    reference: str,
    point: Vector,
    point_frame: str,
    time: int,
    interval: int,
) -> Twist:
    """Return how `tracking` moves in `observation`, averaged over an interval around a time [ns].

    It is expressed in `reference`. The interval ends at the latest time for which there are transforms.

    :raises TransformException: as lookups do.
    """
    latest = tree.latest_common_time(observation, tracking)
    length = interval * 1e-9
    end = min(time * 1e-9 + length * 0.5, latest * 1e-9)
    start = max(_MARGIN + length, end) - length

    def place(target: str, source: str, at: float) -> Transform:
        return tree.lookup(target, source, round(at * 1e9))[0]

    before, after = place(observation, tracking, start), place(observation, tracking, end)
    span = end - start
    linear = _scaled(_minus(after[:3], before[:3]), 1.0 / span)
    angular = rotate(before, _scaled(_rotation_vector(compose(invert(before), after)), 1.0 / span))

    seen = place(reference, tracking, time * 1e-9)
    angular = rotate(seen, angular)
    linear = _plus(rotate(seen, linear), _cross(seen[:3], angular))
    wanted = compose(place(reference, point_frame, time * 1e-9), (*point, 0.0, 0.0, 0.0, 1.0))
    offset = _minus(wanted[:3], seen[:3])
    # Upstream multiplies these element by element.
    return _plus(linear, (angular[0] * offset[0], angular[1] * offset[1], angular[2] * offset[2])), angular


def _rotation_vector(transform: Transform) -> Vector:
    """The axis of a rotation, as long as its angle [rad]."""
    axis = transform[3:6]
    sine = math.hypot(*axis)
    if not sine:
        return 0.0, 0.0, 0.0
    angle = 2.0 * math.atan2(sine, abs(transform[6]))
    return _scaled(axis, math.copysign(angle / sine, transform[6]))


def _plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _scaled(a: Vector, factor: float) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]

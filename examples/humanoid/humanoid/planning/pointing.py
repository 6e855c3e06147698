"""Where a hand goes to point at something."""

from __future__ import annotations

import numpy as np

from ..robot.body import OURS, Body
from ..spatial import Array, rotation_z

_ASIDE, _ABOVE_LEGS = 0.16, 0.39  # where the left shoulder is: to the left, and above straight legs [m]
_REACH = 0.40  # m from the shoulder to the hand: an arm that is nearly straight points

Point = tuple[float, float, float]


def in_footprint(centre: Array, point: Point) -> Point:
    """A point in odom, seen from base_footprint, whose planar pose (3,) is `centre`."""
    away = np.array([point[0] - centre[0], point[1] - centre[1], point[2]])
    x, y, z = (rotation_z(float(centre[2])).T @ away).tolist()
    return x, y, z


def hand_towards(point: Point, body: Body = OURS) -> tuple[str, Point]:
    """The chain of the nearer arm, and where its hand points at a point; both in base_footprint."""
    side = 1 if point[1] >= 0 else -1
    shoulder = np.array([0.0, side * _ASIDE, body.leg_length + _ABOVE_LEGS])
    away = np.array(point) - shoulder
    x, y, z = (shoulder + away * (_REACH / max(float(np.linalg.norm(away)), _REACH))).tolist()
    return ("left_arm" if side > 0 else "right_arm"), (x, y, z)

"""The support polygon: the outline of the soles that carry the robot."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from ..robot.model import SoleGeometry
from ..spatial import Array, from_frame


def support_polygon(soles: Iterable[Array], geometry: SoleGeometry) -> Array:
    """The convex hull (n, 2) of soles at planar poses (3,), counter-clockwise; (0, 2) without soles."""
    back, front = geometry.centre - geometry.half_length, geometry.centre + geometry.half_length
    corners = [
        tuple(from_frame(pose, np.array([x, y])).tolist())
        for pose in soles
        for x in (back, front)
        for y in (-geometry.half_width, geometry.half_width)
    ]
    points = sorted(set(corners))
    return np.array([*_half(points), *_half(points[::-1])]).reshape(-1, 2)


def beyond(point: Array, polygon: Array) -> float:
    """How far a point (2,) is outside a convex polygon (n, 2), counter-clockwise; negative inside [m]."""
    corners = polygon.tolist()
    x, y = point.tolist()
    most = -math.inf
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        out = ((by - ay) * (x - ax) - (bx - ax) * (y - ay)) / math.hypot(bx - ax, by - ay)
        most = max(most, out)
    return most


def _half(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The hull below points in order of x, without the last one (A. M. Andrew's monotone chain)."""
    hull: list[tuple[float, float]] = []
    for point in points:
        while len(hull) > 1 and _turn(hull[-2], hull[-1], point) <= 0:
            hull.pop()
        hull.append(point)
    return hull[:-1]


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    """Positive if the way a, b, c turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

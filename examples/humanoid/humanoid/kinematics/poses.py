"""Poses for testing kinematics: some that a chain can reach, some that it cannot."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..spatial import Array, quaternion_of
from .chains import ChainKinematics

Pose = tuple[Array, Array]
"""Position (3,) in base_link [m], and quaternion (4,)."""


def reachable(tip: ChainKinematics, random: np.random.Generator, count: int) -> Iterator[Pose]:
    """Poses of the tip at random joint positions within their ranges."""
    for _ in range(count):
        position, rotation = tip.forward(random.uniform(tip.lower, tip.upper))
        yield position, quaternion_of(rotation)


def beyond(
    tip: ChainKinematics, random: np.random.Generator, count: int, nearest: float = 1.005
) -> Iterator[Pose]:
    """Positions out of reach by a factor of `nearest` to 1.5, in random directions and orientations."""
    root, length = tip.reach()
    for _ in range(count):
        way = random.normal(size=3)
        far = root + way / np.linalg.norm(way) * length * random.uniform(nearest, 1.5)
        yield far, random.normal(size=4)

"""The frame base_footprint (REP 120), seen from base_link: between the soles, with their mean yaw."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..spatial import Array, matrix_of, quaternion_of, rotation_z, wrap, yaw_of

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
"""The quaternion (x, y, z, w) of no rotation."""


def from_footprint(
    soles: Sequence[tuple[Array, Array]], position: Array, orientation: Array
) -> tuple[Array, Array]:
    """A pose in base_footprint, in base_link: position (3,) and quaternion (4,).

    `soles` are positions (3,) and rotation matrices of the left and the right sole in base_link. A quaternion
    of length 0 stays as it is.
    """
    (left, left_turn), (right, right_turn) = soles
    yaw = yaw_of(left_turn) + wrap(yaw_of(right_turn) - yaw_of(left_turn)) / 2
    turn = rotation_z(yaw)
    origin = (left + right) / 2
    turned = quaternion_of(turn @ matrix_of(orientation)) if orientation.any() else orientation
    return origin + turn @ position, turned

"""Inverse kinematics of a leg in closed form.

Three hip axes intersect, then comes the knee, then two ankle axes that intersect.
"""

from __future__ import annotations

import math

import numpy as np

from ..robot.model import LegGeometry
from ..spatial import Array, rotation_x, rotation_y

_STRAIGHT = 1e-4  # metres by which a fully stretched leg stays shorter than thigh plus shin


def solve_leg(
    leg: LegGeometry, sign: int, pelvis: tuple[Array, Array], ankle: tuple[Array, Array]
) -> tuple[Array, float]:
    """Joint positions (6,) from hip_yaw to ankle_roll that bring the ankle where it is wanted.

    `pelvis` and `ankle` are position (3,) and rotation matrix of base_link and of the link l_ankle or
    r_ankle; `sign` is 1 for the left leg, -1 for the right one. Also returns by how much the ankle is too far
    away for the leg [m], 0 if the leg can reach it. A leg that cannot reach it points there, straight. Joint
    limits are not checked.
    """
    position, rotation = pelvis
    target, turned = ankle
    hip = position + rotation @ np.array([leg.hip[0], sign * leg.hip[1], leg.hip[2]])
    x, y, z = turned.T @ (hip - target)
    distance = math.sqrt(x * x + y * y + z * z)
    reach = min(distance, leg.thigh + leg.shin - _STRAIGHT)
    cosine = (reach**2 - leg.thigh**2 - leg.shin**2) / (2 * leg.thigh * leg.shin)
    knee = math.acos(max(-1.0, min(1.0, cosine)))
    ankle_roll = math.atan2(y, z)
    if abs(ankle_roll) > math.pi / 2:  # the hip is below the ankle: the same axis in the other direction
        ankle_roll -= math.copysign(math.pi, ankle_roll)
    bend = math.asin(max(-1.0, min(1.0, leg.thigh * math.sin(math.pi - knee) / max(reach, 1e-9))))
    ankle_pitch = -math.atan2(x, math.copysign(math.sqrt(y * y + z * z), z)) - bend
    hips = rotation.T @ turned @ rotation_x(-ankle_roll) @ rotation_y(-ankle_pitch - knee)
    yaw = math.atan2(-hips[0, 1], hips[1, 1])
    roll = math.atan2(hips[2, 1], hips[1, 1] * math.cos(yaw) - hips[0, 1] * math.sin(yaw))
    pitch = math.atan2(-hips[2, 0], hips[2, 2])
    return np.array([yaw, roll, pitch, knee, ankle_pitch, ankle_roll]), distance - reach

"""The service CheckHeadPose: whether waist and head can bring the gaze to a pose while the feet stand."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..robot.model import HumanoidModel
from ..spatial import Array
from .chains import CHAINS, ChainKinematics
from .ik import IkRequest, IkStatus, InverseKinematics

POSITION_TOLERANCE = 5e-3  # metres
ORIENTATION_TOLERANCE = 0.02  # radians
_ATTEMPTS = 20


class HeadMode(IntEnum):
    """The kind of request, as in CheckHeadPose.srv."""

    POSE = 0
    LOOK_AT = 1


@dataclass(frozen=True, slots=True)
class HeadPoseResult:
    """The response of CheckHeadPose."""

    reachable: bool
    message: str
    names: tuple[str, ...] = ()
    positions: tuple[float, ...] = ()
    position_residual: float = math.nan
    orientation_residual: float = math.nan


class HeadPose:
    """Answers requests about the head, one after another; targets are in base_link."""

    def __init__(self, model: HumanoidModel) -> None:
        self._solver = InverseKinematics(model)
        self._kinematics = ChainKinematics(model, CHAINS["head"])
        gaze, _ = self._kinematics.forward(np.zeros(5))
        *_, neck, pitch = self._kinematics.anchors()
        self._gaze: Array = gaze - neck  # with the head straight
        self._heights = (float(pitch[2] - neck[2]), float(gaze[2] - pitch[2]))

    def check(
        self,
        mode: int,
        position: Array,
        orientation: Array,
        position_tolerance: float = 0.0,
        orientation_tolerance: float = 0.0,
    ) -> HeadPoseResult:
        """Answer a request; a tolerance of 0 means the server's own."""
        tolerances = (position_tolerance, orientation_tolerance)
        if not all(math.isfinite(number) and number >= 0 for number in tolerances):
            return HeadPoseResult(False, "tolerances must be finite and not negative")
        if not np.isfinite(position).all():
            return HeadPoseResult(False, "the target holds a number that is not finite")
        if mode == HeadMode.LOOK_AT:
            return self._look_at(np.asarray(position, float), orientation_tolerance or ORIENTATION_TOLERANCE)
        if mode != HeadMode.POSE:
            return HeadPoseResult(False, f"there is no mode {mode}")
        request = IkRequest(
            "head",
            position,
            orientation,
            position_tolerance=position_tolerance or POSITION_TOLERANCE,
            orientation_tolerance=orientation_tolerance or ORIENTATION_TOLERANCE,
            attempts=_ATTEMPTS,
        )
        result = self._solver.solve(request)
        return HeadPoseResult(
            result.status is IkStatus.SOLVED,
            result.message,
            result.names,
            result.positions,
            result.position_residual,
            result.orientation_residual,
        )

    def _look_at(self, point: Array, tolerance: float) -> HeadPoseResult:
        """Turn the head and, beyond its range, the waist, each in closed form, until the two agree."""
        kinematics = self._kinematics
        joints = np.zeros(5)
        for _ in range(8):
            yaw, pitch = head_angles(self._in_torso(joints, point), *self._heights)
            head = np.clip([yaw, pitch], kinematics.lower[3:], kinematics.upper[3:])
            joints[3:] = head
            left = np.array([yaw, pitch]) - head
            if not left.any():
                break
            joints[[0, 2]] = np.clip(
                joints[[0, 2]] + left, kinematics.lower[[0, 2]], kinematics.upper[[0, 2]]
            )
        gaze, rotation = kinematics.forward(joints)
        way = point - gaze
        distance = float(np.linalg.norm(way))
        cosine = float(rotation[:, 0] @ way) / distance if distance > 1e-9 else -1.0
        residual = math.acos(max(-1.0, min(1.0, cosine)))
        message = (
            ""
            if residual <= tolerance
            else f"the gaze stays {residual:.3f} rad off: waist and head are at their limits"
        )
        return HeadPoseResult(
            not message, message, kinematics.chain.joints, tuple(float(j) for j in joints), 0.0, residual
        )

    def _in_torso(self, joints: Array, point: Array) -> Array:
        """A point in base_link, seen from the neck with the waist as it is and the head straight."""
        straight = np.concatenate([joints[:3], np.zeros(2)])
        gaze, rotation = self._kinematics.forward(straight)
        return rotation.T @ (point - gaze) + self._gaze


def head_angles(point: Array, pitch_height: float, gaze_height: float) -> tuple[float, float]:
    """Yaw and pitch of the head that point the gaze at a point (3,) seen from the neck.

    The pitch axis is `pitch_height` above the neck, and the gaze is `gaze_height` above that axis [m]: a line
    at a fixed distance from it, in the head's plane of symmetry. Joint limits are not checked.
    """
    yaw = math.atan2(point[1], point[0])
    along, up = math.hypot(point[0], point[1]), point[2] - pitch_height
    distance = math.hypot(along, up)
    elevation = math.atan2(up, along) - math.asin(min(1.0, gaze_height / max(distance, 1e-9)))
    return yaw, -elevation

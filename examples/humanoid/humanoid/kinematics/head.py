"""The service CheckHeadPose: whether waist and head can bring the gaze to a pose while the feet stand."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..robot.model import HumanoidModel
from ..robot.table import HEAD_JOINTS, WAIST_JOINTS
from ..spatial import Array
from .chains import ChainKinematics, chains_of
from .ik import FARTHEST, IkRequest, IkStatus, InverseKinematics

POSITION_TOLERANCE = 5e-3  # metres
ORIENTATION_TOLERANCE = 0.02  # radians
_ATTEMPTS = 20
_JOINTS = (*WAIST_JOINTS, *HEAD_JOINTS)


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
        chain = chains_of(model.body).get("head")
        self._has_neck = chain is not None
        if chain is None:
            return
        self._kinematics = ChainKinematics(model, chain)
        # Places in arrays over the five joints of our waist and head; joints that the robot lacks stay at 0.
        self._places = [_JOINTS.index(name) for name in chain.joints]
        self._lower, self._upper = np.zeros(5), np.zeros(5)
        self._lower[self._places], self._upper[self._places] = self._kinematics.lower, self._kinematics.upper
        gaze, _ = self._forward(np.zeros(5))
        neck, pitch = self._axes(chain.joints)
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
        if not self._has_neck:
            return HeadPoseResult(False, "the robot has no neck: neither head_yaw nor head_pitch")
        tolerances = (position_tolerance, orientation_tolerance)
        if not all(math.isfinite(number) and number >= 0 for number in tolerances):
            return HeadPoseResult(False, "tolerances must be finite and not negative")
        if not np.isfinite(position).all():
            return HeadPoseResult(False, "the target holds a number that is not finite")
        if max(np.abs(position).max(), np.abs(orientation).max()) > FARTHEST:
            return HeadPoseResult(False, "the target holds a number that is not plausible")
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
        lower, upper = self._lower, self._upper
        joints = np.zeros(5)
        for _ in range(8):
            yaw, pitch = head_angles(self._in_torso(joints, point), *self._heights)
            head = np.clip([yaw, pitch], lower[3:], upper[3:])
            joints[3:] = head
            left = np.array([yaw, pitch]) - head
            if not left.any():
                break
            joints[[0, 2]] = np.clip(joints[[0, 2]] + left, lower[[0, 2]], upper[[0, 2]])
        gaze, rotation = self._forward(joints)
        way = point - gaze
        distance = float(np.linalg.norm(way))
        cosine = float(rotation[:, 0] @ way) / distance if distance > 1e-9 else -1.0
        residual = math.acos(max(-1.0, min(1.0, cosine)))
        message = (
            ""
            if residual <= tolerance
            else f"the gaze stays {residual:.3f} rad off: waist and head are at their limits"
        )
        names, positions = self._kinematics.chain.joints, tuple(joints[self._places].tolist())
        return HeadPoseResult(not message, message, names, positions, 0.0, residual)

    def _forward(self, joints: Array) -> tuple[Array, Array]:
        """Position (3,) and rotation matrix of the gaze, for the five joints of waist and head."""
        return self._kinematics.forward(joints[self._places])

    def _axes(self, names: tuple[str, ...]) -> tuple[Array, Array]:
        """Points (3,) on the axes of head_yaw and head_pitch; of a neck with one joint, the same."""
        anchors = dict(zip(names, self._kinematics.anchors(), strict=True))
        yaw, pitch = (anchors.get(name) for name in HEAD_JOINTS)
        neck = yaw if yaw is not None else pitch
        assert neck is not None, "a chain of the head has a joint of the head"
        return neck, neck if pitch is None else pitch

    def _in_torso(self, joints: Array, point: Array) -> Array:
        """A point in base_link, seen from the neck with the waist as it is and the head straight."""
        straight = np.concatenate([joints[:3], np.zeros(2)])
        gaze, rotation = self._forward(straight)
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

"""Waist, head and arms: towards a requested posture, or as people move them when they walk."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..data import Posture
from ..robot.model import HumanoidModel
from ..robot.table import UPPER_BODY
from ..spatial import Array
from .posture import relaxed

_SPEED = 6.0  # rad/s: how fast set-points follow the requested posture
_SQUAT_SPEED = 0.15  # m/s
_DEEPEST = 0.15  # m that the pelvis can be lowered
_SLACK = 1e-3  # rad that a posture may be out of a joint's range
_ARM_SWING = 1.0  # rad of an arm per metre that the foot of the other side is ahead of the pelvis
_LEAN, _LEAN_TIME = 0.10, 0.8  # rad forwards per m/s, and how long it takes to lean [s]


class UpperBody:
    """The requested posture, and the set-points on the way to it."""

    def __init__(self, model: HumanoidModel) -> None:
        self._model = model
        self._relaxed = relaxed(model.body)
        self._deepest = _DEEPEST * model.body.scale
        self._lean = 0.0
        self.asked: Posture | None = None
        self.squat = 0.0  # how far the pelvis is lowered now, metres

    def problem(self, wanted: Posture) -> str:
        """Why numbers of a posture are no posture, or ""."""
        if (
            wanted.position.shape == self._relaxed.shape
            and np.isfinite(wanted.position).all()
            and math.isfinite(wanted.squat)
        ):
            return ""
        return f"a posture needs {self._relaxed.size} finite positions and a finite depth"

    def out_of_reach(self, wanted: Posture) -> str:
        """The reason why a posture cannot be taken, or ""."""
        lower, upper = self._model.lower[UPPER_BODY], self._model.upper[UPPER_BODY]
        beyond = np.maximum(wanted.position - upper, lower - wanted.position)
        worst = int(np.argmax(beyond)) if beyond.size else 0
        if beyond.size and beyond[worst] > _SLACK:
            name, there = self._model.body.upper_body[worst], wanted.position[worst]
            return f"{name} cannot be at {there:.2f} rad: {lower[worst]:.2f} to {upper[worst]:.2f}"
        if not 0.0 <= wanted.squat <= self._deepest:
            return f"the pelvis can be lowered by 0 to {self._deepest:.2g} m, not by {wanted.squat:.2f}"
        return ""

    def move(self, joints: Array, ahead: Sequence[float], speed: float, elapsed: float) -> Array:
        """Joint positions (joints,) after a time [s], moved towards the posture.

        Without one, arms swing with the foot of the other side, so that arms and legs turn the body in
        opposite directions, and the robot leans forwards. `ahead` says how far the soles (left, right) are in
        front of the centre of mass [m], `speed` how fast that moves forwards [m/s].
        """
        self._lean += (_LEAN * speed - self._lean) * min(1.0, elapsed / _LEAN_TIME)
        wanted = self._walking(ahead) if self.asked is None else self.asked.position
        squat = 0.0 if self.asked is None else self.asked.squat
        joints = joints.copy()
        way = _SPEED * elapsed
        joints[UPPER_BODY] += np.clip(wanted - joints[UPPER_BODY], -way, way)
        way = _SQUAT_SPEED * elapsed
        self.squat += min(max(squat - self.squat, -way), way)
        return joints

    def _walking(self, ahead: Sequence[float]) -> Array:
        """The relaxed posture in walking."""
        body = self._model.body
        turned = {
            "l_shoulder_pitch": _ARM_SWING * (ahead[0] - ahead[1]) / 2,
            "r_shoulder_pitch": _ARM_SWING * (ahead[1] - ahead[0]) / 2,
            "waist_pitch": self._lean,
            "head_pitch": -self._lean,  # it goes on looking ahead
        }
        joints = np.zeros(len(body.joints))
        joints[UPPER_BODY] = self._relaxed
        for name in body.those_of(tuple(turned)):
            joints[body.index(name)] += turned[name]
        return np.clip(joints, body.lower, body.upper)[UPPER_BODY]

"""Trunk and arms as a flywheel: they turn to where the robot falls, and that pushes the rest of it back.

The ground pushes no farther out than the edges of the soles. While the trunk is turned ever faster, the
ground's force acts as if it came from farther out. That buys time for a step, or makes one unnecessary.
"""

from __future__ import annotations

import math

import numpy as np

from ..robot.model import GRAVITY, HumanoidModel
from ..spatial import Array

_GYRATION = (
    0.22  # metres: the radius at which all of the mass would turn as hard as what turns with the trunk
)
_IGNORED = 0.02  # metres that the ZMP may be wanted outside the soles without any effect
_MOST, _BRAKE = 40.0, 10.0  # rad/s2 when it is turned, and when it is stopped in front of its limit
_FARTHEST = 0.65  # rad
_RETURN = 4.0  # 1/s: how fast it becomes upright again
_WAIST = 0.5  # how far the waist bends for each radian of the pelvis
# How far an arm swings out on the side from which it falls, and both arms back or to the front.
_OUT, _BACK = 2.5, 2.0
# The axis of the lean (0: roll, 1: pitch), a joint that moves with it, its share, and the lean's sign if only
# one moves it.
_JOINTS = (
    (0, "waist_roll", _WAIST, 0),
    (1, "waist_pitch", _WAIST, 0),
    (0, "l_shoulder_roll", _OUT, 1),
    (0, "r_shoulder_roll", _OUT, -1),
    (1, "l_shoulder_pitch", _BACK, 0),
    (1, "r_shoulder_pitch", _BACK, 0),
)


class Trunk:
    """How far the trunk is turned beyond the wanted posture, about the axes forwards and left; arms help."""

    def __init__(self, model: HumanoidModel) -> None:
        self._model = model
        self._moving = [
            (axis, model.body.index(name), share, sign)
            for axis, name, share, sign in _JOINTS
            if name in model.body.joints
        ]
        self._bend = np.zeros(len(model.body.joints))  # of these, as the last set-points have them
        # Angular acceleration for each metre.
        self._gain = GRAVITY / (_GYRATION * model.body.scale) ** 2
        self._rate, self._acceleration = np.zeros(2), np.zeros(2)
        self.lean = np.zeros(2)  # of the pelvis (2,) [rad]

    def turn(self, beyond: Array, elapsed: float) -> Array:
        """Turn for a time [s]; `beyond` (2,) is how far the ZMP is wanted outside the soles, ahead and left.

        Returns the part of it (2,) that the turning makes up for.
        """
        size = math.hypot(*beyond)
        share = max(0.0, 1 - _IGNORED / max(size, 1e-9))
        wanted = share * self._gain * np.array([-beyond[1], beyond[0]])
        for axis in (0, 1):
            self._acceleration[axis] = self._possible(axis, float(wanted[axis]), elapsed)
        self._rate += self._acceleration * elapsed
        self.lean += self._rate * elapsed
        roll, pitch = self._acceleration / self._gain
        return np.array([pitch, -roll])

    def _possible(self, axis: int, wanted: float, elapsed: float) -> float:
        """The acceleration [rad/s2] nearest to the wanted one after which the trunk can stop at its limit."""
        lean, rate = float(self.lean[axis]), float(self._rate[axis])
        if wanted == 0.0:
            wanted = -(_RETURN**2) * lean - 2 * _RETURN * rate
        fastest, slowest = (math.sqrt(2 * _BRAKE * max(0.0, _FARTHEST - way)) for way in (lean, -lean))
        after = min(max(rate + wanted * elapsed, -slowest), fastest)
        return min(max((after - rate) / elapsed, -_MOST), _MOST)

    def accelerations(self, heading: Array, pelvis: Array) -> Array:
        """What turns the trunk: accelerations of the model's degrees of freedom (nv,), 0 for the others.

        `heading` is the rotation from the axes forwards, left, up to the world, `pelvis` that of base_link.
        """
        found = np.zeros(self._model.mj.nv)
        found[3:6] = pelvis.T @ heading[:, :2] @ self._acceleration
        for axis, joint, share, sign in self._moving:
            if sign * self.lean[axis] >= 0:
                found[self._model.dof[joint]] = share * self._acceleration[axis]
        return found

    def straight(self, joints: Array) -> Array:
        """Joint positions (joints,) without what the present lean adds to waist and arms."""
        return joints - self._bend

    def bent(self, joints: Array) -> Array:
        """Joint positions (joints,) with what the lean adds to waist and arms, within their ranges."""
        bent = joints.copy()
        for axis, joint, share, sign in self._moving:
            if sign * self.lean[axis] >= 0:
                bent[joint] += share * self.lean[axis]
        bent = np.clip(bent, self._model.lower, self._model.upper)
        self._bend = bent - joints
        return bent

"""The trunk as a flywheel: it turns to where the robot falls, and that pushes the rest of the body back.

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
_MOST, _BRAKE = 40.0, 15.0  # rad/s2 when it is turned, and when it is stopped in front of its limit
_FARTHEST = 0.5  # rad
_RETURN = 4.0  # 1/s: how fast it becomes upright again
_WAIST = 0.5  # how far the waist bends for each radian of the pelvis
_JOINTS = ("waist_roll", "waist_pitch")


class Trunk:
    """How far pelvis and waist are turned beyond the wanted posture, about the axes forwards and left."""

    def __init__(self, model: HumanoidModel) -> None:
        self._model = model
        self._waist = [
            (axis, model.body.index(name)) for axis, name in enumerate(_JOINTS) if name in model.body.joints
        ]
        self._bend = np.zeros(len(model.body.joints))  # of the waist, as the last set-points have it
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
        for axis, joint in self._waist:
            found[self._model.dof[joint]] = _WAIST * self._acceleration[axis]
        return found

    def straight(self, joints: Array) -> Array:
        """Joint positions (joints,) without the present bend of the waist."""
        return joints - self._bend

    def bent(self, joints: Array) -> Array:
        """Joint positions (joints,) with the waist bent as the trunk is turned now, within its range."""
        bent = joints.copy()
        for axis, joint in self._waist:
            bent[joint] += _WAIST * self.lean[axis]
        bent = np.clip(bent, self._model.lower, self._model.upper)
        self._bend = bent - joints
        return bent

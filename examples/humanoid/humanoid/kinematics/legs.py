"""Both legs of a robot: joint positions that put its soles where they are wanted.

Legs like ours have a closed form. Others, whose hip axes pass each other at a distance, are solved step by
step from where they were: at 250 Hz the first or second step is accurate to a micrometre.
"""

from __future__ import annotations

import numpy as np

from ..robot.model import HumanoidModel
from ..spatial import Array
from .chains import ChainKinematics, chains_of
from .leg_ik import solve_leg

_STEPS = 12
_CLOSE = 1e-6  # metres, and radians
_FAR = 1e-3  # of the error that is left: another start is tried
_TURN_WEIGHT = 0.3  # metres of error that a radian counts as
_DAMPING = 1e-3  # m: keeps the steps of a stretched leg short
_LONGEST = 0.4  # rad that a joint moves in one step
_BENT = 0.8  # rad of the knee that the second search starts from


class Legs:
    """The inverse kinematics of both legs."""

    def __init__(self, model: HumanoidModel) -> None:
        self._model = model
        chains = chains_of(model.body)
        self._chains = [ChainKinematics(model, chains[f"{side}_leg"]) for side in ("left", "right")]
        self._bent = [_bent(chain) for chain in self._chains]

    def solve(self, side: int, pelvis: tuple[Array, Array], sole: tuple[Array, Array], start: Array) -> Array:
        """Joint positions (6,) of a leg, 0 left or 1 right, from hip_yaw to ankle_roll.

        `pelvis` and `sole` are position (3,) and rotation matrix of base_link and of the sole. A search
        begins at `start` (6,), and stays within the joints' limits; the closed form does not. A leg that
        cannot reach its sole's place points there.
        """
        position, rotation = sole
        if self._model.has_our_legs:
            above = rotation @ np.array([0.0, 0.0, self._model.leg.ankle_height])
            return solve_leg(self._model.leg, 1 - 2 * side, pelvis, (position + above, rotation))[0]
        turned = pelvis[1].T
        target = (turned @ (position - pelvis[0]), turned @ rotation)
        joints, left = self._search(side, start, target)
        if left > _FAR:
            again = self._search(side, self._bent[side], target)
            joints = again[0] if again[1] < left else joints
        return joints

    def _search(self, side: int, start: Array, target: tuple[Array, Array]) -> tuple[Array, float]:
        """Damped Newton steps; returns the joints and the error that is left [m]."""
        chain = self._chains[side]
        joints = best = np.clip(start, chain.lower, chain.upper)
        least = np.inf
        for _ in range(_STEPS):
            error = chain.error(joints, target)
            error[3:] *= _TURN_WEIGHT
            left = float(np.abs(error).max())
            if left < least:
                best, least = joints, left
            if left < _CLOSE:
                break
            jacobian = chain.jacobian()
            jacobian[3:] *= _TURN_WEIGHT
            step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + _DAMPING**2 * np.eye(6), error)
            longest = float(np.abs(step).max())
            joints = np.clip(joints + step * min(1.0, _LONGEST / longest), chain.lower, chain.upper)
        return best, least


def _bent(chain: ChainKinematics) -> Array:
    """A leg at zero with a bent knee, which bends towards the far end of its range."""
    joints = np.zeros(6)
    lower, upper = chain.lower[3], chain.upper[3]
    joints[3] = _BENT if upper > -lower else -_BENT
    return joints

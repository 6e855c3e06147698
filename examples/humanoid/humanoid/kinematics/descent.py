"""Damped least squares with an active set: joints at their limits do not take part in a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..spatial import Array
from .chains import ChainKinematics

_ROTATION_WEIGHT = 0.3  # metres that count as much as a radian
_STEP = 0.6  # rad that a joint moves at most in one step
_ITERATIONS = 60
_STALLED = 6  # iterations in a row that each improve by less than half a percent


@dataclass(frozen=True, slots=True)
class Tolerance:
    """The errors that count as solved: metres, radians (infinite: any orientation will do)."""

    position: float
    orientation: float

    def met(self, error: Array) -> bool:
        """Whether an error (6,) is small enough."""
        return bool(
            np.linalg.norm(error[:3]) <= self.position and np.linalg.norm(error[3:]) <= self.orientation
        )


def descend(
    kinematics: ChainKinematics, start: Array, target: tuple[Array, Array], tolerance: Tolerance
) -> tuple[Array, Array]:
    """From one start to the next minimum: joint positions within limits, and the error (6,) left."""
    weight = np.array([1.0] * 3 + [_ROTATION_WEIGHT if np.isfinite(tolerance.orientation) else 0.0] * 3)
    joints = np.clip(start, kinematics.lower, kinematics.upper)
    error = kinematics.error(joints, target)
    cost = float(np.sum((weight * error) ** 2))
    damping, stalled = 1e-2, 0
    for _ in range(_ITERATIONS):
        if tolerance.met(error) or stalled >= _STALLED:
            break
        jacobian = weight[:, None] * kinematics.jacobian()
        gradient = jacobian.T @ (weight * error)
        free = ~(
            ((joints <= kinematics.lower + 1e-9) & (gradient < 0))
            | ((joints >= kinematics.upper - 1e-9) & (gradient > 0))
        )
        normal = jacobian[:, free].T @ jacobian[:, free]
        for _ in range(6):
            step = np.zeros_like(joints)
            step[free] = np.linalg.solve(normal + damping * np.eye(len(normal)), gradient[free])
            step *= min(1.0, _STEP / max(float(np.abs(step).max()), 1e-12))
            tried = np.clip(joints + step, kinematics.lower, kinematics.upper)
            left = kinematics.error(tried, target)
            new = float(np.sum((weight * left) ** 2))
            if new < cost:
                break
            damping *= 6
        else:
            break
        stalled = stalled + 1 if new > 0.995 * cost else 0
        joints, error, cost = tried, left, new
        damping = max(0.3 * damping, 1e-7)
    return joints, error

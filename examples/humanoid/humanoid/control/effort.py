"""Which torques move the body as the reference does: the inverse dynamics of the whole robot.

Wanted are the acceleration of the centre of mass, of both feet, and of the trunk that turns. From these
follow the accelerations of all joints, and from them what the ground must push with and the torques. A leg
that swings throws the body the other way; here the stance leg expects that.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..kinematics.dynamics import RobotState
from ..robot.model import GRAVITY
from ..robot.table import LEGS
from ..spatial import Array
from .balance import Load

_STIFFNESS, _DAMPING = 30.0, 6.0  # of the centre of mass's height, 1/s2 and 1/s
_MOST = 150.0  # rad/s2 of a leg's joint; an almost straight leg would need any number
_SINGULAR = 1e-3  # regularisation of an almost straight leg
_LEGS = slice(LEGS[0].start, LEGS[1].stop)


def wanted_force(state: RobotState, zmp: Array, omega: float, height: float) -> Array:
    """The force (3,) of the ground that accelerates the centre of mass away from a ZMP (2,).

    `omega` is the natural frequency [1/s], `height` the wanted height of the centre of mass [m].
    """
    com, velocity, mass = state.com, state.com_velocity, state.model.mass
    pull = mass * omega**2 * (com[:2] - zmp)
    lift = mass * (GRAVITY + _STIFFNESS * (height - com[2]) - _DAMPING * velocity[2])
    return np.array([pull[0], pull[1], lift])


class Motion:
    """Accelerations of all joints that give the ground's force and the feet's accelerations."""

    def __init__(self, state: RobotState, force: Array, feet: Sequence[Array], turning: Array) -> None:
        """Solve for the ground's force (3,) and the accelerations (6,) of both soles, linear then angular.

        `turning` (nv,) are the accelerations of the pelvis' rotation and of the joints of waist, head and
        arms, which are decided already.
        """
        self._state = state
        mass, bias = state.mass_matrix, state.generalized_bias
        legs = state.model.dof[_LEGS]
        matrix, wanted = np.zeros((15, 15)), np.zeros(15)
        matrix[:3, :3], matrix[:3, 3:] = mass[:3, :3], mass[:3, legs]
        wanted[:3] = force - bias[:3] - mass[:3] @ turning
        for side, acceleration in enumerate(feet):
            jacobian, drift = state.sole_jacobian(side)
            rows = slice(3 + 6 * side, 9 + 6 * side)
            matrix[rows, :3], matrix[rows, 3:] = jacobian[:, :3], jacobian[:, legs]
            wanted[rows] = acceleration - drift - jacobian @ turning
        square = matrix.T @ matrix
        square[np.diag_indices(15)] += _SINGULAR**2
        solved = np.linalg.solve(square, matrix.T @ wanted)
        acceleration = turning.copy()
        acceleration[:3] = solved[:3]
        acceleration[legs] = np.clip(solved[3:], -_MOST, _MOST)
        self._torque = mass @ acceleration + bias

    def pressure_point(self, force: Array) -> Array:
        """The point (2,) of the floor where the ground must push with a force (3,) to keep the body level."""
        position, rotation = self._state.base
        x, y, _ = rotation @ self._torque[3:6]
        down = min(self._state.sole(side)[0][2] for side in (0, 1)) - position[2]
        away = np.array([down * force[0] - y, x + down * force[1]]) / max(float(force[2]), 1.0)
        return position[:2] + away

    def torques(self, force: Array, load: Load) -> Array:
        """Torques (joints,) while the ground pushes with a force (3,) on the soles as `load` says."""
        torque = self._torque[self._state.model.dof].copy()
        for side, share in enumerate(load.shares):
            if share > 0:
                arm = load.points[side] - self._state.sole(side)[0][:2]
                x, y, z = share * force
                moment = np.array([arm[1] * z, -arm[0] * z, arm[0] * y - arm[1] * x])
                torque += self._state.contact_torque(side, share * force, moment)
        return torque

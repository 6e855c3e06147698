"""A robot's state as balancing needs it: centre of mass, soles, Jacobians, torques of gravity and motion."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from ..robot.model import GRAVITY, HumanoidModel
from ..robot.table import SIDES
from ..spatial import Array, matrix_of


class RobotState:
    """Kinematics and dynamics of one posture at a time, on a MuJoCo state of its own."""

    def __init__(self, model: HumanoidModel) -> None:
        self.model = model
        self._data = model.data()
        self._soles = [model.frames[f"{side}_sole"] for side in SIDES]
        self._jacobians = [(np.zeros((3, model.mj.nv)), np.zeros((3, model.mj.nv))) for _ in SIDES]

    def set_posture(self, position: Array, orientation: Array, joints: Array) -> None:
        """Take base_link's position (3,) and quaternion and all joints; compute where everything is."""
        x, y, z, w = orientation
        self._data.qpos[:3] = position
        self._data.qpos[3:7] = (w, x, y, z)
        self._data.qpos[self.model.qpos] = joints
        mujoco.mj_kinematics(self.model.mj, self._data)
        mujoco.mj_comPos(self.model.mj, self._data)

    def set_motion(self, linear: Array, angular: Array, joints: Array) -> None:
        """Take velocities: base_link's in the world (3,), its spin in base_link (3,), all joints'."""
        self._data.qvel[:3] = linear
        self._data.qvel[3:6] = angular
        self._data.qvel[self.model.dof] = joints

    def compute_dynamics(self) -> None:
        """Compute the values of `com_velocity` and `bias` from posture and motion."""
        mujoco.mj_comVel(self.model.mj, self._data)
        mujoco.mj_subtreeVel(self.model.mj, self._data)
        mujoco.mj_rne(self.model.mj, self._data, 0, self._data.qfrc_bias)
        mujoco.mj_crb(self.model.mj, self._data)

    @property
    def com(self) -> Array:
        """The centre of mass (3,)."""
        return np.array(self._data.subtree_com[self.model.base])

    @property
    def com_velocity(self) -> Array:
        """The velocity of the centre of mass (3,)."""
        return np.array(self._data.subtree_linvel[self.model.base])

    @property
    def bias(self) -> Array:
        """Joint torques (joints,) that counter gravity and motion, as if nothing touched the robot."""
        return np.asarray(self._data.qfrc_bias[self.model.dof])

    @property
    def generalized_bias(self) -> Array:
        """The same for all degrees of freedom of the model; base_link's six come first."""
        return np.array(self._data.qfrc_bias)

    @property
    def mass_matrix(self) -> Array:
        """Force per acceleration, for all degrees of freedom of the model."""
        matrix = np.zeros((self.model.mj.nv, self.model.mj.nv))
        mujoco.mj_fullM(self.model.mj, self._data, matrix)
        return matrix

    @property
    def base(self) -> tuple[Array, Array]:
        """Position (3,) and rotation matrix of base_link."""
        return self._data.xpos[self.model.base].copy(), self._data.xmat[self.model.base].reshape(3, 3).copy()

    def sole(self, side: int) -> tuple[Array, Array]:
        """Position (3,) and rotation matrix of a sole: 0 the left one, 1 the right one."""
        site = self._soles[side]
        return self._data.site_xpos[site].copy(), self._data.site_xmat[site].reshape(3, 3).copy()

    def planar_sole(self, side: int) -> Array:
        """Planar pose (3,) of a sole."""
        site = self._soles[side]
        position, matrix = self._data.site_xpos[site], self._data.site_xmat[site]
        return np.array([position[0], position[1], math.atan2(matrix[3], matrix[0])])

    def sole_velocity(self, side: int) -> Array:
        """The velocity (3,) of a sole."""
        velocities: Array = self._data.qvel
        return self._jacobian(side)[0] @ velocities

    def sole_jacobian(self, side: int) -> tuple[Array, Array]:
        """The Jacobian (6, nv) of a sole, linear then angular, and its acceleration (6,) if no joint's is."""
        linear, angular = self._jacobian(side)
        drift, turning = np.zeros_like(linear), np.zeros_like(angular)
        site = self._soles[side]
        body = self.model.mj.site_bodyid[site]
        mujoco.mj_jacDot(self.model.mj, self._data, drift, turning, self._data.site_xpos[site], body)
        velocities: Array = self._data.qvel
        return np.vstack((linear, angular)), np.vstack((drift, turning)) @ velocities

    def contact_torque(self, side: int, force: Array, torque: Array) -> Array:
        """Joint torques (joints,) that make the ground answer with a force and torque (3,) at the sole."""
        linear, angular = self._jacobian(side)
        return -(linear.T @ force + angular.T @ torque)[self.model.dof]

    def _jacobian(self, side: int) -> tuple[Array, Array]:
        linear, angular = self._jacobians[side]
        mujoco.mj_jacSite(self.model.mj, self._data, linear, angular, self._soles[side])
        return linear, angular


def natural_frequency(height: float) -> float:
    """The rate [1/s] at which an inverted pendulum falls, with its mass at a height [m]."""
    return math.sqrt(GRAVITY / height)


def world_velocity(orientation: Array, velocity: Array) -> Array:
    """Convert a velocity (3,) from the axes of a frame to those of the world."""
    return matrix_of(orientation) @ velocity

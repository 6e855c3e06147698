"""Kinematic chains: named joints in a row with a frame at the tip, and how the tip follows the joints."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import mujoco
import numpy as np

from ..robot.body import OURS, Body
from ..robot.model import HumanoidModel
from ..robot.table import ARM_JOINTS, HEAD_JOINTS, LEG_JOINTS, SEVENTH, WAIST_JOINTS
from ..spatial import Array, vector_of


@dataclass(frozen=True, slots=True)
class Chain:
    """The joints from base_link outwards, and the frame that they move."""

    joints: tuple[str, ...]
    tip: str


def _side(prefix: str, names: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{prefix}_{name}" for name in names)


_ARM = (*ARM_JOINTS, SEVENTH)
_WHOLE: dict[str, Chain] = {
    "left_arm": Chain(_side("l", _ARM), "l_gripper"),
    "right_arm": Chain(_side("r", _ARM), "r_gripper"),
    "left_arm_with_waist": Chain((*WAIST_JOINTS, *_side("l", _ARM)), "l_gripper"),
    "right_arm_with_waist": Chain((*WAIST_JOINTS, *_side("r", _ARM)), "r_gripper"),
    "left_leg": Chain(_side("l", LEG_JOINTS), "l_sole"),
    "right_leg": Chain(_side("r", LEG_JOINTS), "r_sole"),
    "head": Chain((*WAIST_JOINTS, *HEAD_JOINTS), "gaze"),
}
_NEEDED = {
    "left_arm": _side("l", _ARM), "right_arm": _side("r", _ARM), "left_arm_with_waist": _side("l", _ARM),
    "right_arm_with_waist": _side("r", _ARM), "head": HEAD_JOINTS,
}  # fmt: skip


def chains_of(body: Body) -> dict[str, Chain]:
    """The chains of a robot, with those of their joints that it has; a limb without any is none."""
    return {
        name: Chain(body.those_of(chain.joints), chain.tip)
        for name, chain in _WHOLE.items()
        if body.those_of(_NEEDED.get(name, chain.joints))
    }


CHAINS = chains_of(OURS)
"""The chains of our own robot."""


class ChainKinematics:
    """The pose of a chain's tip in base_link, and its motion with the joints."""

    def __init__(self, model: HumanoidModel, chain: Chain) -> None:
        self.chain = chain
        self.indices = np.array([model.body.index(name) for name in chain.joints])
        self.lower, self.upper = model.lower[self.indices], model.upper[self.indices]
        self._model = model
        self._data = model.data()
        self._data.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)  # base_link is the world
        self._site = model.frames[chain.tip]
        self._addresses = model.qpos[self.indices]
        self._columns = model.dof[self.indices]
        self._linear, self._angular = np.zeros((3, model.mj.nv)), np.zeros((3, model.mj.nv))

    def set_others(self, joints: Array) -> None:
        """Take the positions (joints,) of all joints; those outside the chain stay as they are."""
        self._data.qpos[self._model.qpos] = joints

    def forward(self, joints: Array) -> tuple[Array, Array]:
        """Position (3,) and rotation matrix of the tip."""
        self._data.qpos[self._addresses] = joints
        mujoco.mj_kinematics(self._model.mj, self._data)
        return self._data.site_xpos[self._site].copy(), self._data.site_xmat[self._site].reshape(3, 3).copy()

    def error(self, joints: Array, target: tuple[Array, Array]) -> Array:
        """The error that is left to the target (6,): distance and rotation vector, in base_link."""
        position, rotation = self.forward(joints)
        return np.concatenate([target[0] - position, vector_of(target[1] @ rotation.T)])

    def jacobian(self) -> Array:
        """The Jacobian (6, joints) of the tip, at the positions last passed to `forward` or `error`."""
        mujoco.mj_comPos(self._model.mj, self._data)
        mujoco.mj_jacSite(self._model.mj, self._data, self._linear, self._angular, self._site)
        return np.vstack([self._linear[:, self._columns], self._angular[:, self._columns]])

    def anchors(self) -> Array:
        """Points on the joints' axes (joints, 3), at the joint positions passed last."""
        return np.array(self._data.xanchor[self._model.joints[self.indices]])

    def reach(self) -> tuple[Array, float]:
        """The start (3,) of the chain in base_link, with the other joints as they are, and its length."""
        mujoco.mj_kinematics(self._model.mj, self._data)
        anchors = self.anchors()
        points = [*anchors, self._data.site_xpos[self._site]]
        lengths = (float(np.linalg.norm(b - a)) for a, b in pairwise(points))
        return anchors[0], sum(lengths)

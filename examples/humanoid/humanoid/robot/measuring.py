"""Measures a compiled robot: how long its legs are, how high it stands, whether they are built like ours."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from ..spatial import Array
from . import table

_MEET = 1e-3  # within which axes count as meeting and parallel: metres, and sine of the angle
_STRAIGHTEST = 241  # knee angles that are tried


@dataclass(frozen=True, slots=True)
class Measures:
    """The sizes of a robot's lower body; left before right, metres."""

    leg_lengths: tuple[float, float]  # from the hip's pitch axis down to the sole, straight
    straight_height: float  # of the centre of mass above the soles, with straight legs and arms at zero
    outwards: tuple[float, float]  # of the soles from the robot's middle plane
    has_our_legs: bool  # so that their inverse kinematics has a closed form


def measure(mj: mujoco.MjModel, joints: Any, base: int) -> Measures:
    """Measure a robot; `joints` are the ids of its twelve leg joints in the order of the table.

    Its frames l_sole and r_sole must be there.
    """
    data = at_zero(mj)
    lengths = tuple(_length(mj, data, joints[leg], side) for leg, side in zip(table.LEGS, "lr", strict=True))
    soles = [data.site_xpos[mj.site(f"{side}_sole").id].copy() for side in "lr"]
    hip = float(data.xanchor[joints[2]][2])
    mujoco.mj_comPos(mj, data)
    height = float(data.subtree_com[base][2]) - hip + lengths[0]
    outwards = (float(soles[0][1]), -float(soles[1][1]))
    fits = all(_is_ours(data, joints[leg], leg) for leg in table.LEGS)
    return Measures((lengths[0], lengths[1]), height, outwards, fits)


def at_zero(mj: mujoco.MjModel) -> mujoco.MjData:
    """A state with all hinges at zero and the base at the origin, with everything's place computed."""
    data = mujoco.MjData(mj)
    data.qpos[:] = 0.0
    free = mj.jnt_type == mujoco.mjtJoint.mjJNT_FREE
    data.qpos[mj.jnt_qposadr[free] + 3] = 1.0
    mujoco.mj_kinematics(mj, data)
    return data


def _length(mj: mujoco.MjModel, data: mujoco.MjData, leg: Any, side: str) -> float:
    """The length of a leg [m], with its knee where the leg is longest."""
    trial = mujoco.MjData(mj)
    trial.qpos[:] = data.qpos
    lower, upper = mj.jnt_range[leg[3]]
    longest = 0.0
    for angle in np.linspace(lower, upper, _STRAIGHTEST):
        trial.qpos[mj.jnt_qposadr[leg[3]]] = angle
        mujoco.mj_kinematics(mj, trial)
        x, _, z = trial.xanchor[leg[4]] - trial.xanchor[leg[2]]
        longest = max(longest, math.hypot(x, z))
    sole = data.site_xpos[mj.site(f"{side}_sole").id]
    return longest + float(data.xanchor[leg[4]][2] - sole[2])


def _is_ours(data: mujoco.MjData, joints: Any, leg: slice) -> bool:
    """Whether a leg turns about our axes, which meet in hip and ankle, and hangs straight down at zero."""
    axes, anchors = data.xaxis[joints], data.xanchor[joints]
    ours = np.array([joint.axis for joint in table.JOINTS[leg]])
    hip, knee, ankle = anchors[0], anchors[3], anchors[4]
    below = np.array([0.0, 0.0, 1.0])
    places: Array = np.array([hip, hip, hip, hip - (hip[2] - knee[2]) * below, ankle, ankle])
    straight = np.abs((knee - ankle)[:2]).max() < _MEET
    return bool(straight and np.abs(axes - ours).max() < _MEET and np.abs(anchors - places).max() < _MEET)

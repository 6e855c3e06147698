"""Standing: arms slightly bent, and legs that hold the centre of mass above a point at a wanted height."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..kinematics.dynamics import RobotState
from ..kinematics.legs import Legs
from ..robot.body import OURS, Body
from ..robot.model import HumanoidModel
from ..robot.table import LEGS, UPPER_BODY
from ..spatial import Array, quaternion_of, rotation_z
from .fitting import fitted
from .reference import GaitParameters, middle

_NOD = 0.35  # rad: the camera sees the floor from 1.2 m ahead on, and faces of people
_RELAXED = {"shoulder_pitch": 0.15, "shoulder_roll": 0.12, "elbow": -0.55}  # of the left arm


def relaxed(body: Body = OURS) -> Array:
    """Positions of waist, head and arms when no other posture is requested, as `body.upper_body`."""
    pose = {"head_pitch": _NOD}
    for name, position in _RELAXED.items():
        pose[f"l_{name}"] = position
        pose[f"r_{name}"] = -position if name.endswith(("roll", "yaw")) else position
    return posed(body, pose)


def posed(body: Body, pose: Mapping[str, float], others: Array | None = None) -> Array:
    """Positions of waist, head and arms, as `body.upper_body`: those of a pose, the others at `others`, or 0.

    Joints that the robot lacks are left out, and none leaves its range.
    """
    first = UPPER_BODY.start
    joints = np.zeros(len(body.joints))
    joints[UPPER_BODY] = 0.0 if others is None else others
    for name, position in pose.items():
        if name in body.joints:
            joints[body.index(name)] = position
    return np.clip(joints, body.lower, body.upper)[first:]


def level(foot: Array, height: float = 0.0) -> tuple[Array, Array]:
    """Position and rotation of a level sole: a planar pose, and a height above the floor."""
    return np.array([foot[0], foot[1], height]), rotation_z(foot[2])


def start(model: HumanoidModel) -> tuple[Array, Array]:
    """Joint positions (joints,) and base_link's position (3,) of a robot that stands at the origin."""
    parameters = fitted(GaitParameters(), model)
    feet = [np.array([0.0, side * parameters.stance_width / 2, 0.0]) for side in (1, -1)]
    return standing(model, feet, parameters)


def standing(
    model: HumanoidModel, feet: Sequence[Array], parameters: GaitParameters, upper_body: Array | None = None
) -> tuple[Array, Array]:
    """Joint positions and base_link's position (3,) of a robot upright on both feet (planar poses)."""
    joints = np.zeros(len(model.lower))
    joints[UPPER_BODY] = relaxed(model.body) if upper_body is None else upper_body
    state, legs = RobotState(model), Legs(model)
    centre = middle(feet, parameters)
    rotation = rotation_z((feet[0][2] + feet[1][2]) / 2)
    com = np.array([centre[0], centre[1], parameters.com_height])
    base = com
    for _ in range(
        30
    ):  # the legs' own weight moves the centre of mass: a fixed-point iteration, accurate to micrometres
        state.set_posture(np.zeros(3), quaternion_of(rotation), joints)
        base = com - state.com
        for side, leg in enumerate(LEGS):
            joints[leg] = legs.solve(side, (base, rotation), level(feet[side]), joints[leg])
    return joints, base

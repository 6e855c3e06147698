"""What planners and messages must know of a robot's body: its joints in order, and its size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..spatial import Array
from . import table


@dataclass(frozen=True, slots=True)
class Body:
    """The joints of a robot, in the order of every array over joints, and the sizes that its gait depends on.

    The legs come first, six joints each; waist, head and arms follow. A robot has those of our joints that
    its maker gave it, under our names, and then those of its own.
    """

    joints: tuple[str, ...]
    lower: Array  # (joints,) rad
    upper: Array
    leg_length: float  # from the hip to the sole of a straight leg, metres
    stance_width: float  # between the soles of a robot that stands, metres
    foot: tuple[float, float]  # length and width of a sole, metres
    crouch: float  # by which its centre of mass may be lower than on straight legs, metres

    @property
    def scale(self) -> float:
        """How long its legs are, as a multiple of ours."""
        return self.leg_length / OURS.leg_length

    @property
    def upper_body(self) -> tuple[str, ...]:
        """The joints of waist, head and arms, and those that only this robot has."""
        return self.joints[table.UPPER_BODY.start :]

    def those_of(self, names: Sequence[str]) -> tuple[str, ...]:
        """The joints among `names` that the robot has."""
        return tuple(name for name in names if name in self.joints)

    def index(self, joint: str) -> int:
        """The place of a joint in arrays over joints. Raises ValueError if the robot lacks it."""
        return self.joints.index(joint)


OURS = Body(
    table.JOINT_NAMES,
    np.array([joint.lower for joint in table.JOINTS]),
    np.array([joint.upper for joint in table.JOINTS]),
    table.THIGH + table.SHIN + table.ANKLE_HEIGHT,
    table.STANCE_WIDTH,
    (table.FOOT_LENGTH, table.FOOT_WIDTH),
    0.105,
)
"""The robot of the table."""
STRAIGHT_HEIGHT = 0.7223
"""The height of its centre of mass above the soles on straight legs [m]."""


def load_body(model_file: str = "", joint_map: str = "") -> Body:
    """Our own body, or that of the robot which the parameters name by file and map. Raises ModelError."""
    if not model_file:
        return OURS
    from .external import load_model  # planners do not need MuJoCo to plan for our own robot

    return load_model(model_file, joint_map).body

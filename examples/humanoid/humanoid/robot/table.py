"""The robot as one table: links, joints, shapes, frames. MJCF and URDF are both written from it.

Lengths in metres, angles in radians, masses in kilograms, torques in newton metres. Link axes at rest follow
REP 103 (x forward, y left, z up); the frames have the names of REP 120.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import Literal

Vector = tuple[float, float, float]

NAME = "ifgen_humanoid"


class ModelError(Exception):
    """A model or a joint map that cannot be used; the text names the file and the element."""


HIP_OFFSET: Vector = (0.0, 0.09, -0.06)  # of the left hip in base_link
THIGH = SHIN = 0.30
ANKLE_HEIGHT = 0.06  # of the ankle's axes above the sole
FOOT_LENGTH, FOOT_WIDTH, FOOT_HEIGHT = 0.22, 0.11, 0.035
FOOT_CENTRE = 0.02  # of the sole's box, ahead of the ankle
STANCE_WIDTH = 2 * HIP_OFFSET[1]
WAIST_HEIGHT = 0.08
UPPER_ARM, FOREARM, HAND = 0.20, 0.18, 0.09
CAMERA_FOVY = 60.0  # vertical field of view of the head camera, degrees
IMU_FRAME, CAMERA_FRAME = "imu_link", "head_camera_optical_frame"

DARK, LIGHT, BLUE = (0.16, 0.17, 0.19), (0.82, 0.84, 0.86), (0.10, 0.45, 0.85)
_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_ORIGIN: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Joint:
    """A hinge and its servo: torque = kp (command - position) - kv velocity, at most `effort`."""

    name: str
    axis: Vector
    lower: float
    upper: float
    effort: float
    kp: float
    kv: float
    armature: float


@dataclass(frozen=True, slots=True)
class Shape:
    """A solid of uniform density, which collides and is visible.

    `size` is (x, y, z) of half lengths for a box and an ellipsoid, (radius, half length of the cylinder, 0)
    for a capsule, which lies along z, and (radius, 0, 0) for a sphere.
    """

    kind: Literal["box", "capsule", "ellipsoid", "sphere"]
    size: Vector
    mass: float
    colour: Vector
    position: Vector = _ORIGIN
    name: str = ""


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body. `origin` is the origin of its axes in those of the parent; at rest they are parallel."""

    name: str
    parent: str
    origin: Vector
    joint: Joint | None  # None for base_link, which floats
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Frame:
    """A coordinate frame fixed to a link; `rpy` turns about x, then y, then z of the link."""

    name: str
    link: str
    origin: Vector
    rpy: Vector = _ORIGIN


def _capsule(radius: float, top: float, bottom: float, mass: float, colour: Vector) -> Shape:
    """An upright capsule between two heights of its axis."""
    return Shape("capsule", (radius, (top - bottom) / 2, 0.0), mass, colour, (0.0, 0.0, (top + bottom) / 2))


def _ball(radius: float, mass: float, colour: Vector) -> Shape:
    return Shape("sphere", (radius, 0.0, 0.0), mass, colour)


def _leg() -> tuple[Link, ...]:
    """The left leg. Hip and ankle axes intersect, so that its inverse kinematics has a closed form."""
    foot = Shape(
        "box",
        (FOOT_LENGTH / 2, FOOT_WIDTH / 2, FOOT_HEIGHT / 2),
        0.7,
        LIGHT,
        (FOOT_CENTRE, 0.0, FOOT_HEIGHT / 2 - ANKLE_HEIGHT),
        "l_foot",
    )
    return (
        Link("l_hip_yaw_link", "base_link", HIP_OFFSET, Joint("l_hip_yaw", _Z, -1.2, 1.2, 90, 250, 6, 0.02),
             (_capsule(0.045, 0.05, 0.01, 0.8, BLUE),)),
        Link("l_hip_roll_link", "l_hip_yaw_link", _ORIGIN,
             Joint("l_hip_roll", _X, -0.7, 0.7, 120, 500, 12, 0.02), (_ball(0.05, 0.8, DARK),)),
        Link("l_thigh", "l_hip_roll_link", _ORIGIN, Joint("l_hip_pitch", _Y, -2.0, 1.2, 120, 500, 12, 0.02),
             (_capsule(0.055, -0.03, 0.04 - THIGH, 2.6, LIGHT),)),
        Link("l_shin", "l_thigh", (0.0, 0.0, -THIGH), Joint("l_knee", _Y, -0.05, 2.4, 150, 500, 12, 0.02),
             (_capsule(0.043, 0.0, 0.05 - SHIN, 1.9, DARK),)),
        Link("l_ankle_link", "l_shin", (0.0, 0.0, -SHIN),
             Joint("l_ankle_pitch", _Y, -1.0, 0.8, 60, 150, 5, 0.015), (_ball(0.032, 0.25, BLUE),)),
        Link("l_ankle", "l_ankle_link", _ORIGIN, Joint("l_ankle_roll", _X, -0.5, 0.5, 50, 150, 5, 0.015),
             (foot,)),
    )  # fmt: skip


def _trunk() -> tuple[Link, ...]:
    """Waist, torso and head."""
    torso = (
        Shape("box", (0.07, 0.11, 0.15), 8.0, LIGHT, (0.0, 0.0, 0.19)),
        Shape("box", (0.01, 0.07, 0.05), 0.1, BLUE, (0.072, 0.0, 0.22)),
    )
    head = (
        Shape("ellipsoid", (0.08, 0.075, 0.10), 1.0, LIGHT, (0.0, 0.0, 0.07)),
        Shape("box", (0.012, 0.055, 0.02), 0.05, DARK, (0.072, 0.0, 0.08)),
    )
    return (
        Link("waist_yaw_link", "base_link", (0.0, 0.0, WAIST_HEIGHT),
             Joint("waist_yaw", _Z, -2.0, 2.0, 90, 300, 8, 0.02),
             (_capsule(0.05, 0.015, -0.015, 0.5, BLUE),)),
        Link("waist_roll_link", "waist_yaw_link", _ORIGIN,
             Joint("waist_roll", _X, -0.5, 0.5, 60, 400, 10, 0.02), (_ball(0.05, 0.5, DARK),)),
        Link("torso", "waist_roll_link", _ORIGIN,
             Joint("waist_pitch", _Y, -0.5, 0.9, 60, 400, 10, 0.02), torso),
        Link("neck", "torso", (0.0, 0.0, 0.36), Joint("head_yaw", _Z, -1.5, 1.5, 6, 20, 1, 0.005),
             (_capsule(0.03, 0.03, -0.03, 0.2, DARK),)),
        Link("head", "neck", (0.0, 0.0, 0.06), Joint("head_pitch", _Y, -0.7, 0.9, 6, 20, 1, 0.005), head),
    )  # fmt: skip


def _arm() -> tuple[Link, ...]:
    """The left arm, hanging down at rest."""
    hand = Shape("box", (0.022, 0.035, 0.045), 0.35, LIGHT, (0.0, 0.0, -0.06))
    return (
        Link("l_shoulder_pitch_link", "torso", (0.0, 0.14, 0.30),
             Joint("l_shoulder_pitch", _Y, -3.0, 2.0, 30, 60, 3, 0.01), (_ball(0.045, 0.6, BLUE),)),
        Link("l_shoulder_roll_link", "l_shoulder_pitch_link", (0.0, 0.05, 0.0),
             Joint("l_shoulder_roll", _X, -0.35, 2.4, 30, 60, 3, 0.01), (_ball(0.045, 0.5, DARK),)),
        Link("l_upper_arm", "l_shoulder_roll_link", _ORIGIN,
             Joint("l_shoulder_yaw", _Z, -2.2, 2.2, 20, 40, 2, 0.01),
             (_capsule(0.036, -0.03, 0.02 - UPPER_ARM, 1.0, LIGHT),)),
        Link("l_forearm", "l_upper_arm", (0.0, 0.0, -UPPER_ARM),
             Joint("l_elbow", _Y, -2.3, 0.05, 25, 40, 2, 0.01),
             (_capsule(0.03, 0.0, 0.03 - FOREARM, 0.7, DARK),)),
        Link("l_wrist_roll_link", "l_forearm", (0.0, 0.0, -FOREARM),
             Joint("l_wrist_roll", _Z, -1.9, 1.9, 8, 15, 0.8, 0.005), (_ball(0.028, 0.15, BLUE),)),
        Link("l_wrist", "l_wrist_roll_link", _ORIGIN,
             Joint("l_wrist_pitch", _Y, -1.4, 1.4, 8, 15, 0.8, 0.005), (hand,)),
    )  # fmt: skip


def _mirrored(name: str) -> str:
    return "r_" + name.removeprefix("l_") if name.startswith("l_") else name


def _right(link: Link) -> Link:
    """The right-hand counterpart of a left link: y and rotations about x and z change their sign."""
    joint = link.joint
    assert joint is not None
    if joint.axis != _Y:
        joint = replace(joint, lower=-joint.upper, upper=-joint.lower)
    x, y, z = link.origin
    return Link(
        _mirrored(link.name),
        _mirrored(link.parent),
        (x, -y, z),
        replace(joint, name=_mirrored(joint.name)),
        tuple(replace(shape, name=_mirrored(shape.name)) for shape in link.shapes),
    )


_PELVIS = Shape("box", (0.07, 0.09, 0.06), 4.0, DARK)
LINKS: tuple[Link, ...] = (
    Link("base_link", "", _ORIGIN, None, (_PELVIS,)),
    *_leg(),
    *map(_right, _leg()),
    *_trunk(),
    *_arm(),
    *map(_right, _arm()),
)
JOINTS: tuple[Joint, ...] = tuple(link.joint for link in LINKS if link.joint is not None)
JOINT_NAMES: tuple[str, ...] = tuple(joint.name for joint in JOINTS)

FRAMES: tuple[Frame, ...] = (
    Frame(IMU_FRAME, "base_link", _ORIGIN),
    Frame("l_sole", "l_ankle", (0.0, 0.0, -ANKLE_HEIGHT)),
    Frame("r_sole", "r_ankle", (0.0, 0.0, -ANKLE_HEIGHT)),
    Frame("gaze", "head", (0.085, 0.0, 0.08)),
    Frame(CAMERA_FRAME, "head", (0.09, 0.0, 0.08), (-pi / 2, 0.0, -pi / 2)),  # z forward, x right
    Frame("l_gripper", "l_wrist", (0.0, 0.0, -HAND), (0.0, pi / 2, 0.0)),  # x out of the hand
    Frame("r_gripper", "r_wrist", (0.0, 0.0, -HAND), (0.0, pi / 2, 0.0)),
)

LEG_JOINTS = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll")
ARM_JOINTS = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow", "wrist_roll", "wrist_pitch")
WAIST_JOINTS = ("waist_yaw", "waist_roll", "waist_pitch")
HEAD_JOINTS = ("head_yaw", "head_pitch")
SEVENTH = "wrist_yaw"  # of arms that have one joint more than ours
SIDES = ("l", "r")
# Joint numbers: the columns of every array over joints.
LEGS = (slice(0, 6), slice(6, 12))
WAIST, HEAD = slice(12, 15), slice(15, 17)
ARMS = (slice(17, 23), slice(23, 29))
UPPER_BODY = slice(12, None)

"""The compiled model for controllers and simulator, with the addresses of everything that the table names."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from ..spatial import Array
from . import table
from .body import OURS, Body
from .measuring import Measures, at_zero, measure
from .mjcf import TIMESTEP, write_mjcf
from .obstacles import Solid, add_solids

Indices = NDArray[np.intp]
GRAVITY = 9.81
_ANKLE_ROOM = 0.4  # rad
_GAP = 0.06  # metres between the inner edges of the soles
SERVO_DELAY = 12_000_000  # ns from a set-point to the torque that it leads to
PERIOD = 4_000_000  # ns between control ticks: 250 Hz; more makes the estimate of the velocity too coarse


@dataclass(frozen=True, slots=True)
class LegGeometry:
    """The lengths that the closed-form leg kinematics needs [m]; the hip is the left one."""

    hip: Array  # (3,) in base_link
    thigh: float
    shin: float
    ankle_height: float  # above the sole frame


@dataclass(frozen=True, slots=True)
class SoleGeometry:
    """The rectangle of a sole, in its frame."""

    centre: float  # ahead of the sole frame
    half_length: float
    half_width: float


SOLE = SoleGeometry(table.FOOT_CENTRE, table.FOOT_LENGTH / 2, table.FOOT_WIDTH / 2)


@dataclass(frozen=True, slots=True)
class Names:
    """The names of a robot's joints, ours: theirs, in the order of every array, and of its bodies."""

    joints: Mapping[str, str]
    base: str
    torso: str


@dataclass(frozen=True, slots=True)
class HumanoidModel:
    """A compiled model and the addresses in its arrays. Joint arrays are in the order of `body.joints`."""

    mj: mujoco.MjModel
    base: int  # body id of base_link
    torso: int  # body id
    joints: Indices  # (joints,) joint ids
    qpos: Indices  # (joints,) addresses of the joints
    dof: Indices  # (joints,)
    actuators: Indices  # (joints,)
    lower: Array  # (joints,) rad
    upper: Array
    effort: Array  # N m
    kp: Array  # gains of the position servos
    kv: Array
    frames: dict[str, int]  # site ids
    sensors: dict[str, slice]  # places in sensordata
    leg: LegGeometry
    has_our_legs: bool  # so that `leg` says all, and their inverse kinematics has a closed form
    sole: SoleGeometry
    body: Body
    straight_height: float  # of the centre of mass above the soles, with straight legs [m]
    mass: float

    def data(self) -> mujoco.MjData:
        """A new state of this model, to compute with."""
        return mujoco.MjData(self.mj)


# MuJoCo writes its warnings into a file in the current folder.
mujoco.set_mju_user_warning(logging.getLogger("mujoco").warning)


def load(timestep: float = TIMESTEP, solids: Sequence[Solid] = ()) -> HumanoidModel:
    """Compile the robot of the table in its scene, with obstacles."""
    spec = mujoco.MjSpec.from_string(write_mjcf(timestep))
    add_solids(spec, solids)
    mj = spec.compile()
    names = Names({name: name for name in table.JOINT_NAMES}, "base_link", "torso")
    return replace(describe(mj, names, SOLE), body=OURS)


def describe(mj: mujoco.MjModel, names: Names, sole: SoleGeometry) -> HumanoidModel:
    """Look up everything that controllers and simulator use in a compiled model.

    Sites, sensors and actuators must have our names; the lengths of the legs are measured.
    """
    joints = np.array([mj.joint(name).id for name in names.joints.values()])
    actuators = np.array([mj.actuator(name).id for name in names.joints])
    base = mj.body(names.base).id
    frames = (*(frame.name for frame in table.FRAMES), "l_ankle", "r_ankle")
    lower, upper = mj.jnt_range[joints].T.copy()
    measures = measure(mj, joints[:12], base)
    return HumanoidModel(
        mj=mj,
        base=base,
        torso=mj.body(names.torso).id,
        joints=joints,
        qpos=mj.jnt_qposadr[joints].astype(np.intp),
        dof=mj.jnt_dofadr[joints].astype(np.intp),
        actuators=actuators,
        lower=lower,
        upper=upper,
        effort=mj.actuator_forcerange[actuators, 1].copy(),
        kp=mj.actuator_gainprm[actuators, 0].copy(),
        kv=-mj.actuator_biasprm[actuators, 2],
        frames={site.name: site.id for site in map(mj.site, range(mj.nsite)) if site.name in frames},
        sensors=_sensors(mj),
        leg=_leg(mj, joints[:6]),
        has_our_legs=measures.has_our_legs,
        sole=sole,
        body=Body(
            tuple(names.joints),
            lower,
            upper,
            min(measures.leg_lengths),
            _stance(measures, sole),
            (2 * sole.half_length, 2 * sole.half_width),
            _crouch(mj, joints[:6]),
        ),
        straight_height=measures.straight_height,
        mass=float(mj.body_subtreemass[base]),
    )


def _stance(measures: Measures, sole: SoleGeometry) -> float:
    """The distance between the soles of a robot that stands [m].

    They are below the hips, but no farther apart than ours for the length of the legs: the wider they are,
    the more the robot sways. Feet need a gap between them.
    """
    usual = OURS.stance_width * min(measures.leg_lengths) / OURS.leg_length
    return min(sum(measures.outwards), max(usual, 2 * sole.half_width + _GAP))


def _crouch(mj: mujoco.MjModel, leg: Indices) -> float:
    """The distance by which legs may be bent [m]: ankles need room for the end of a step."""
    geometry = _leg(mj, leg)
    axis = float(at_zero(mj).xaxis[leg[4]][1])
    lower, upper = mj.jnt_range[leg[4]]
    bend = max(0.0, (-lower if axis > 0 else upper) - _ANKLE_ROOM)
    return (geometry.thigh + geometry.shin) * (1 - math.cos(bend))


def _leg(mj: mujoco.MjModel, joints: Indices) -> LegGeometry:
    """The lengths of the left leg, which hangs straight down when all joints are at zero."""
    data = mujoco.MjData(mj)
    data.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
    mujoco.mj_kinematics(mj, data)
    hip, knee, ankle = (data.xanchor[joints[i]].copy() for i in (0, 3, 4))
    sole = data.site_xpos[mj.site("l_sole").id]
    return LegGeometry(hip, float(hip[2] - knee[2]), float(knee[2] - ankle[2]), float(ankle[2] - sole[2]))


def _sensors(mj: mujoco.MjModel) -> dict[str, slice]:
    """The place of every sensor in sensordata, by name."""
    return {
        mj.sensor(i).name: slice(mj.sensor_adr[i], mj.sensor_adr[i] + mj.sensor_dim[i])
        for i in range(mj.nsensor)
    }

"""Whether a model can walk at all: one sentence that names the element which prevents it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from ..data import SECOND
from . import table
from .measuring import at_zero, measure
from .model import GRAVITY, PERIOD, HumanoidModel
from .table import ModelError

_ALIGNED = 0.05  # sine of the angle between an axis and ours
_LIKE_OURS = 0.7  # cosine of the same, for arms, whose zero is not always hanging down
_GRAVITY_OFF = 0.2  # m/s2: it varies by less than this from place to place on earth
_SHORTEST_LEG, _UNEQUAL = 0.35, 0.01  # metres
_SHORTEST_SOLE, _NARROWEST_SOLE = 0.12, 0.05  # metres
_STANCES = (0.12, 0.36)  # metres between the soles
# What walking takes of a joint: the weight, times a lever arm. The arms are shares of the leg's length, of
# the distance between the soles, and of half a sole. 99 of 100 moments of a walk at 0.5 m/s take less, on our
# legs as on shorter ones and on those with offset hips.
_LEG_ARMS = {"knee": 0.32, "hip_pitch": 0.14}
_STANCE_ARMS = {"hip_roll": 0.6}
_SOLE_ARM = {"ankle_pitch": 1.0, "ankle_roll": 0.4}


def check_parts(path: Path, mj: mujoco.MjModel, base_name: str, joints: dict[str, str]) -> None:
    """Check what must hold for any humanoid: its first body floats, and every joint has limits."""
    base = mj.body(base_name)
    if mj.jnt_qposadr[base.jntadr[0]] != 0:
        raise ModelError(f"{path}: body '{base_name}' is not the first that moves; put it before all others")
    for ours, theirs in joints.items():
        joint = mj.joint(theirs)
        what = f"'{theirs}'" if ours == theirs else f"'{theirs}' for '{ours}'"
        if not joint.limited:
            raise ModelError(f"{path}: joint {what} has no range, or an empty one")
        if not np.isfinite(joint.range).all():
            raise ModelError(f"{path}: joint {what} has a range that is not a number")
    for body in map(mj.body, range(mj.nbody)):
        if not all(np.isfinite(part).all() for part in (body.pos, body.quat, body.mass, body.inertia)):
            raise ModelError(f"{path}: body '{body.name}' has a place or a mass that is not a number")
    if not 0 < mj.opt.timestep <= PERIOD / SECOND:
        raise ModelError(
            f"{path}: option timestep is {mj.opt.timestep:g} s; it must not be above {PERIOD / SECOND:g} s"
        )
    if np.abs(mj.opt.gravity - (0.0, 0.0, -GRAVITY)).max() > _GRAVITY_OFF:
        text = " ".join(f"{part:g}" for part in mj.opt.gravity)
        raise ModelError(f"{path}: option gravity is '{text}'; the robot balances in '0 0 -{GRAVITY:g}'")


def check_walkable(path: Path, model: HumanoidModel, joints: dict[str, str]) -> None:
    """Check that the model can walk. Raises ModelError, which names what is too short, small or weak."""
    _check_axes(path, model, joints)
    _check_sizes(path, model, joints)
    _check_strength(path, model, joints)


def _check_axes(path: Path, model: HumanoidModel, joints: dict[str, str]) -> None:
    """Waist and head turn about our axes, and arms roughly so: postures have a meaning only then."""
    data = at_zero(model.mj)
    ours = {joint.name: joint for joint in table.JOINTS}
    arms = {f"{side}_{name}" for side in table.SIDES for name in ("shoulder_pitch", "shoulder_roll")}
    for number, name in enumerate(model.body.joints):
        axis, wanted = data.xaxis[model.joints[number]], ours.get(name)
        if wanted is None:
            continue
        if name in (*table.WAIST_JOINTS, *table.HEAD_JOINTS):
            fits = np.abs(axis - wanted.axis).max() <= _ALIGNED
        else:
            fits = name not in arms or float(axis @ wanted.axis) > _LIKE_OURS
        if not fits:
            text = ", ".join(f"{part:g}" for part in np.round(axis, 3) + 0.0)
            raise ModelError(
                f"{path}: joint '{joints[name]}' turns about ({text}) with all joints at zero; "
                f"'{name}' turns about ({', '.join(f'{part:g}' for part in wanted.axis)})"
            )


def _check_sizes(path: Path, model: HumanoidModel, joints: dict[str, str]) -> None:
    measures = measure(model.mj, model.joints[:12], model.base)
    left, right = measures.leg_lengths
    knee = joints["l_knee"]
    if abs(left - right) > _UNEQUAL:
        raise ModelError(
            f"{path}: the leg of joint '{knee}' is {left:.3f} m long and that of '{joints['r_knee']}' "
            f"{right:.3f} m: the robot walks on equal legs"
        )
    if min(left, right) < _SHORTEST_LEG:
        raise ModelError(
            f"{path}: the leg of joint '{knee}' is {min(left, right):.2f} m long from hip to sole; walking "
            f"takes {_SHORTEST_LEG} m"
        )
    if np.abs(np.subtract(*measures.outwards)) > _UNEQUAL:
        raise ModelError(
            f"{path}: l_sole is {measures.outwards[0]:.3f} m to the left of "
            f"'{model.mj.body(model.base).name}' and r_sole {measures.outwards[1]:.3f} m to the right, "
            "with all joints at zero"
        )
    apart = sum(measures.outwards)
    if not _STANCES[0] <= apart <= _STANCES[1]:
        raise ModelError(
            f"{path}: the soles are {apart:.2f} m apart with all joints at zero; the robot "
            f"walks with {_STANCES[0]} to {_STANCES[1]} m"
        )
    length, width = model.body.foot
    if length < _SHORTEST_SOLE or width < _NARROWEST_SOLE:
        raise ModelError(
            f"{path}: the sole of '{model.mj.body(_foot(model)).name}' is {length:.3f} m long and "
            f"{width:.3f} m wide; walking takes {_SHORTEST_SOLE} by {_NARROWEST_SOLE} m"
        )


def _check_strength(path: Path, model: HumanoidModel, joints: dict[str, str]) -> None:
    weight = model.mass * GRAVITY
    arms = {name: share * model.body.leg_length for name, share in _LEG_ARMS.items()}
    arms |= {name: share * model.body.stance_width for name, share in _STANCE_ARMS.items()}
    arms["ankle_pitch"] = _SOLE_ARM["ankle_pitch"] * model.sole.half_length
    arms["ankle_roll"] = _SOLE_ARM["ankle_roll"] * model.sole.half_width
    for number, name in enumerate(model.body.joints[:12]):
        needed = weight * arms.get(name[2:], 0.0)
        if model.effort[number] < needed:
            raise ModelError(
                f"{path}: joint '{joints[name]}' has {model.effort[number]:.3g} N m; walking "
                f"with {model.mass:.3g} kg takes {needed:.2g} N m there"
            )


def _foot(model: HumanoidModel) -> int:
    return int(model.mj.site_bodyid[model.frames["l_sole"]])

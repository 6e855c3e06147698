"""Somebody else's robot: an MJCF file, and a map that names its joints and frames.

The map is YAML:

    base: pelvis                      # the body that floats
    torso: trunk                      # the body that arms and head hang on; base if there is none
    sole: {centre: 0.02, length: 0.22, width: 0.11}   # of the sole's rectangle in l_sole; metres
    joints:                           # ours: theirs; a joint with the same name can be left out
      l_knee: left_knee_joint
    frames:                           # ours: one of their sites, or a place in a body
      l_sole: left_sole
      r_sole: {body: right_foot, xyz: [0, 0, -0.06], rpy: [0, 0, 0]}

Servos, sensors and missing frames are added.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from .adapting import Adapter
from .body import OURS, STRAIGHT_HEIGHT
from .joint_map import JointMap, read_map
from .model import SOLE, HumanoidModel, Names, describe, load
from .obstacles import Solid, add_solids
from .table import ModelError
from .walkable import check_parts, check_walkable

_MEASURED = 1e-4  # metres and radians: how exactly a body can be measured
_UNREADABLE = re.compile(r"XML parse error (\d+).*Error=XML_(?:ERROR_)?(\w+).*Line number=(\d+)", re.DOTALL)


def load_model(model_file: str = "", joint_map: str = "", solids: Sequence[Solid] = ()) -> HumanoidModel:
    """Load our own robot, or the one that the parameters name by file and map. Raises ModelError."""
    if not model_file:
        return load(solids=solids)
    return load_external(Path(model_file), Path(joint_map) if joint_map else None, solids)


def load_external(path: Path, joint_map: Path | None = None, solids: Sequence[Solid] = ()) -> HumanoidModel:
    """Compile somebody else's model. Raises ModelError, which names the element that is wrong."""
    names = read_map(joint_map) if joint_map is not None else JointMap()
    spec = _parse(path)
    try:
        adapter = Adapter(path, spec, names)
        adapter.adapt()
        add_solids(spec, solids)
        mj = spec.compile()
    except ValueError as error:
        raise ModelError(f"{path}: {_sentence(error)}") from error
    check_parts(path, mj, names.base, adapter.joints)
    model = describe(mj, Names(adapter.joints, names.base, adapter.torso), adapter.sole)
    check_walkable(path, model, adapter.joints)
    # A body of our size is ours to the last digit, so that our robot moves alike from whatever file it comes.
    return replace(model, body=OURS, sole=SOLE) if _is_our_size(model) else model


def _is_our_size(model: HumanoidModel) -> bool:
    """Whether a robot has our joints and our measures, as exactly as these can be measured."""
    body = model.body
    if body.joints != OURS.joints or not model.has_our_legs:
        return False
    sole = (model.sole.centre - SOLE.centre, *np.subtract(body.foot, OURS.foot))
    off = (
        body.leg_length - OURS.leg_length,
        body.stance_width - OURS.stance_width,
        model.straight_height - STRAIGHT_HEIGHT,
        *sole,
        *(body.lower - OURS.lower),
        *(body.upper - OURS.upper),
    )
    return bool(np.abs(off).max() < _MEASURED)


def _parse(path: Path) -> mujoco.MjSpec:
    if not path.is_file():
        raise ModelError(f"{path}: {'this is a folder' if path.is_dir() else 'there is no such file'}")
    if path.suffix.lower() != ".xml":  # MuJoCo decides by the suffix
        raise ModelError(f"{path}: the name of a model must end in .xml")
    try:
        return mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise ModelError(f"{path}: {_sentence(error)}") from error


def _sentence(error: ValueError) -> str:
    """MuJoCo's message on one line: it names the element and its line."""
    if unreadable := _UNREADABLE.search(str(error)):
        number, kind, line = unreadable.groups()
        words = kind.lower().replace("_", " ")
        return f"XML parse error {number} in line {line}: {words}: is this an XML file?"
    return "; ".join(line.strip() for line in str(error).splitlines() if line.strip())

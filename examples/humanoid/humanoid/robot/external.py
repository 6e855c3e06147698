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
from pathlib import Path

import mujoco

from . import table
from .adapting import Adapter
from .joint_map import JointMap, ModelError, read_map
from .model import HumanoidModel, Names, describe, load
from .obstacles import Solid, add_solids
from .walkable import check_parts, check_walkable

_ALIGNED = 1e-3  # tolerance of the axes: metres, and sine of the angle
_GRAVITY_OFF = 0.2  # m/s2: it varies by less than this from place to place on earth
_UNREADABLE = re.compile(r"XML parse error (\d+).*Error=XML_(?:ERROR_)?(\w+).*Line number=(\d+)", re.DOTALL)
_LINK = {frame.name: frame for frame in table.FRAMES}
_JOINT = {link.name: link.joint.name for link in table.LINKS if link.joint is not None}


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
    return model


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

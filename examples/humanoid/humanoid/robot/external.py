"""Somebody else's robot: an MJCF file, and a map that names its joints and frames.

The map is YAML:

    base: pelvis                      # the body that floats
    torso: trunk                      # the body that arms and head hang on
    sole: {centre: 0.02, length: 0.22, width: 0.11}   # of the sole's rectangle in l_sole; metres
    joints:                           # ours: theirs; a joint with the same name can be left out
      l_knee: left_knee_joint
    frames:                           # ours: one of their sites, or a place in a body
      l_sole: left_sole
      r_sole: {body: right_foot, xyz: [0, 0, -0.06], rpy: [0, 0, 0]}

Servos, sensors and missing frames are added.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from ..data import SECOND
from ..spatial import quaternion_of, rotation_rpy
from . import table
from .joint_map import Frame, JointMap, ModelError, read_map
from .model import GRAVITY, PERIOD, SOLE, HumanoidModel, Names, describe, load
from .obstacles import Solid, add_solids

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
        _Adapter(path, spec, names).adapt()
        add_solids(spec, solids)
        mj = spec.compile()
    except ValueError as error:
        raise ModelError(f"{path}: {_sentence(error)}") from error
    joints = {name: names.joints.get(name, name) for name in table.JOINT_NAMES}
    _check(path, mj, names, joints)
    model = describe(mj, Names(joints, names.base, names.torso), names.sole or SOLE)
    _check_legs(path, model, joints)
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


@dataclass(frozen=True, slots=True)
class _Adapter:
    """Adds to a model what the table has and the model lacks, under the names of the table."""

    path: Path
    spec: mujoco.MjSpec
    names: JointMap

    def adapt(self) -> None:
        """Add frames, servos, sensors, camera and floor."""
        base = self._body(self.names.base, "base")
        self._body(self.names.torso, "torso")
        if not any(joint.type == mujoco.mjtJoint.mjJNT_FREE for joint in base.joints):
            raise ModelError(f"{self.path}: body '{base.name}' has no free joint, so the robot cannot move")
        bodies = {"base_link": base}
        for link, name in _JOINT.items():
            bodies[link] = self._joint(name).parent
        for frame in (*table.FRAMES, *_ankles()):
            self._frame(frame, bodies)
        self._servos()
        self._sensors()
        self._surroundings()

    def _body(self, name: str, ours: str) -> Any:
        body = self.spec.body(name)
        if body is None:
            raise ModelError(f"{self.path}: no body '{name}' for '{ours}'{_near(name, self.spec.bodies)}")
        return body

    def _joint(self, ours: str) -> Any:
        """The joint that corresponds to one of ours."""
        theirs = self.names.joints.get(ours, ours)
        joint = self.spec.joint(theirs)
        if joint is None:
            raise ModelError(
                f"{self.path}: no joint '{theirs}' for '{ours}'{_near(theirs, self.spec.joints)}"
            )
        if joint.type != mujoco.mjtJoint.mjJNT_HINGE:
            raise ModelError(f"{self.path}: joint '{theirs}' is not a hinge")
        return joint

    def _frame(self, frame: table.Frame, bodies: dict[str, Any]) -> None:
        """Add a site with the name of the frame."""
        place = self.names.frames.get(frame.name)
        if isinstance(place, str):
            site = self.spec.site(place)
            if site is None:
                raise ModelError(
                    f"{self.path}: no site '{place}' for '{frame.name}'{_near(place, self.spec.sites)}"
                )
            if place != frame.name:
                site.parent.add_site(name=frame.name, pos=site.pos, quat=site.quat)
        elif place is not None:
            self._add_site(self._body(place.body, frame.name), frame.name, place)
        elif self.spec.site(frame.name) is None:
            self._add_site(bodies[frame.link], frame.name, Frame("", frame.origin, frame.rpy))

    @staticmethod
    def _add_site(body: Any, name: str, place: Frame) -> None:
        x, y, z, w = quaternion_of(rotation_rpy(*place.rpy))
        body.add_site(name=name, pos=place.xyz, quat=[w, x, y, z])

    def _servos(self) -> None:
        """Replace the actuators by position servos with the gains of the table."""
        for actuator in list(self.spec.actuators):
            self.spec.delete(actuator)
        for joint in table.JOINTS:
            theirs = self._joint(joint.name)
            servo = self.spec.add_actuator(
                name=joint.name, target=theirs.name, trntype=mujoco.mjtTrn.mjTRN_JOINT
            )
            servo.set_to_position(kp=joint.kp, kv=joint.kv)
            servo.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
            servo.forcerange = [-joint.effort, joint.effort]
            theirs.armature = max(float(theirs.armature), joint.armature)  # stiff servos shake light links

    def _sensors(self) -> None:
        """Replace the sensors by those that the simulator reads."""
        for sensor in list(self.spec.sensors):
            self.spec.delete(sensor)
        kinds = mujoco.mjtSensor
        wanted = [
            ("imu_orientation", kinds.mjSENS_FRAMEQUAT, table.IMU_FRAME),
            ("imu_angular_velocity", kinds.mjSENS_GYRO, table.IMU_FRAME),
            ("imu_linear_acceleration", kinds.mjSENS_ACCELEROMETER, table.IMU_FRAME),
        ]
        sole = self.names.sole or SOLE
        for side in table.SIDES:
            site = self.spec.site(f"{side}_sole")
            if (taken := self.spec.site(f"{side}_sole_touch")) is not None:
                self.spec.delete(taken)
            touch = site.parent.add_site(
                name=f"{side}_sole_touch",
                type=mujoco.mjtGeom.mjGEOM_BOX,
                pos=site.pos + np.array([sole.centre, 0.0, 0.0]),
                size=[sole.half_length + 0.01, sole.half_width + 0.01, 0.02],
                rgba=[0, 0, 0, 0],
            )
            wanted += [
                (f"{side}_foot_force", kinds.mjSENS_FORCE, f"{side}_ankle"),
                (f"{side}_foot_torque", kinds.mjSENS_TORQUE, f"{side}_ankle"),
                (f"{side}_foot_touch", kinds.mjSENS_TOUCH, touch.name),
            ]
        for name, kind, site in wanted:
            self.spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=site)

    def _surroundings(self) -> None:
        """Add a floor, a light and the head camera if they are missing."""
        geometry = mujoco.mjtGeom.mjGEOM_PLANE
        if not any(geom.type == geometry for geom in self.spec.worldbody.geoms):
            self.spec.worldbody.add_geom(type=geometry, size=[0, 0, 0.05], friction=[1.0, 0.02, 0.001])
        if not self.spec.lights:
            self.spec.worldbody.add_light(pos=[0, 0, 4], dir=[0.2, 0.2, -1])
        if self.spec.camera("head_camera") is None:
            site = self.spec.site(table.CAMERA_FRAME)
            # A MuJoCo camera looks along -z: half a turn about x of the optical frame.
            w, x, y, z = site.quat
            site.parent.add_camera(
                name="head_camera", pos=site.pos, quat=[-x, w, z, -y], fovy=table.CAMERA_FOVY
            )


def _ankles() -> tuple[table.Frame, ...]:
    return tuple(table.Frame(f"{side}_ankle", f"{side}_ankle", (0.0, 0.0, 0.0)) for side in table.SIDES)


def _near(name: str, elements: Iterable[Any]) -> str:
    """A suggestion of what may have been meant."""
    close = difflib.get_close_matches(name, [element.name for element in elements if element.name], n=1)
    return f"; did you mean '{close[0]}'?" if close else ""


def _check(path: Path, mj: mujoco.MjModel, names: JointMap, joints: dict[str, str]) -> None:
    """Check what must hold for any humanoid: its first body floats, and every joint has limits."""
    base = mj.body(names.base)
    if mj.jnt_qposadr[base.jntadr[0]] != 0:
        raise ModelError(f"{path}: body '{names.base}' is not the first that moves; put it before all others")
    for ours, theirs in joints.items():
        joint = mj.joint(theirs)
        if not joint.limited:
            raise ModelError(f"{path}: joint '{theirs}' for '{ours}' has no range, or an empty one")
        if not np.isfinite(joint.range).all():
            raise ModelError(f"{path}: joint '{theirs}' for '{ours}' has a range that is not a number")
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


def _check_legs(path: Path, model: HumanoidModel, joints: dict[str, str]) -> None:
    """Check that legs and trunk turn about the axes of the table."""
    data = model.data()
    data.qpos[:7] = (0, 0, 0, 1, 0, 0, 0)
    data.qpos[model.qpos] = 0.0
    mujoco.mj_kinematics(model.mj, data)
    for number in range(table.HEAD.stop):
        joint, axis = table.JOINTS[number], data.xaxis[model.joints[number]]
        if np.abs(axis - joint.axis).max() > _ALIGNED:
            text = ", ".join(f"{part:g}" for part in np.round(axis, 3) + 0.0)
            raise ModelError(
                f"{path}: joint '{joints[joint.name]}' turns about ({text}) with all joints at zero; "
                f"'{joint.name}' turns about ({', '.join(f'{part:g}' for part in joint.axis)})"
            )

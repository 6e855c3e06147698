"""Adds to somebody else's model what ours has and it lacks: frames, servos, sensors, a floor."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from ..spatial import quaternion_of, rotation_rpy
from . import table
from .feet import Foot, measured_foot
from .joint_map import KNOWN_JOINTS, REQUIRED_JOINTS, Frame, JointMap
from .measuring import at_zero
from .model import SoleGeometry
from .table import ModelError

_JOINT = {link.name: link.joint.name for link in table.LINKS if link.joint is not None}
_USUAL = {joint.name: joint for joint in table.JOINTS}
_OTHER = table.Joint("", (0.0, 0.0, 1.0), 0.0, 0.0, 20, 40, 2, 0.005)  # the servo of a joint that ours lacks
_OURS = 35.05 * (table.THIGH + table.SHIN + table.ANKLE_HEIGHT)  # kg m: what our servos carry
_STRONGEST, _WEAKEST = 5.0, 0.1  # times our gains


@dataclass(slots=True)
class Adapter:
    """A model that is being made ready; `spec` is somebody else's, and changes."""

    path: Path
    spec: mujoco.MjSpec
    names: JointMap
    joints: dict[str, str] = field(default_factory=dict)  # ours, or its own: theirs; in our order
    torso: str = ""
    sole: SoleGeometry = field(default_factory=lambda: SoleGeometry(0.0, 0.0, 0.0))
    sites: list[Any] = field(default_factory=list)  # of theirs, with names

    def adapt(self) -> None:
        """Add what is missing. Raises ModelError, or ValueError if MuJoCo does not compile the model."""
        base = self._body(self.names.base, "base")
        self.torso = self.names.torso or self._usual_torso()
        self._body(self.torso, "torso")
        if not any(joint.type == mujoco.mjtJoint.mjJNT_FREE for joint in base.joints):
            raise ModelError(f"{self.path}: body '{base.name}' has no free joint, so the robot cannot move")
        for ours in KNOWN_JOINTS:
            theirs = self.names.joints.get(ours, ours)
            named = ours in self.names.joints or ours in REQUIRED_JOINTS
            if named or self.spec.joint(theirs) is not None:
                self._hinge(ours, theirs)
                self.joints[ours] = theirs
        bare = self.spec.compile()
        self.sites = [site for site in self.spec.sites if site.name]
        self._add_others(bare)
        feet = [measured_foot(bare, self.joints[f"{side}_ankle_roll"]) for side in table.SIDES]
        self._soles(feet)
        self._frames(base)
        self._servos(bare)
        self._sensors()
        self._surroundings()

    def _body(self, name: str, ours: str) -> Any:
        body = self.spec.body(name)
        if body is None:
            raise ModelError(f"{self.path}: no body '{name}' for '{ours}'{_near(name, self.spec.bodies)}")
        return body

    def _usual_torso(self) -> str:
        """The body with our name for it; a robot in one piece above its legs has none."""
        return "torso" if self.spec.body("torso") is not None else self.names.base

    def _hinge(self, ours: str, theirs: str) -> None:
        """Check the joint that corresponds to one of ours."""
        joint = self.spec.joint(theirs)
        if joint is None:
            raise ModelError(
                f"{self.path}: no joint '{theirs}' for '{ours}'{_near(theirs, self.spec.joints)}"
            )
        if joint.type != mujoco.mjtJoint.mjJNT_HINGE:
            raise ModelError(f"{self.path}: joint '{theirs}' is not a hinge")

    def _add_others(self, mj: mujoco.MjModel) -> None:
        """Take on the joints that have no counterpart: a servo holds each where it is."""
        base = mj.body(self.names.base).id
        taken = set(self.joints.values())
        for joint in map(mj.joint, range(mj.njnt)):
            kind = joint.type[0]
            if mj.body_rootid[joint.bodyid[0]] != base or kind == mujoco.mjtJoint.mjJNT_FREE:
                continue
            if kind == mujoco.mjtJoint.mjJNT_BALL:
                raise ModelError(f"{self.path}: joint '{joint.name}' is a ball; servos turn hinges only")
            if not joint.name:
                body = mj.body(joint.bodyid[0]).name
                raise ModelError(f"{self.path}: a joint of body '{body}' has no name, so nothing can move it")
            if joint.name not in taken:
                self.joints[joint.name] = joint.name

    def _soles(self, feet: list[Foot | None]) -> None:
        """Add the frames of the soles where the feet are flat, unless the map or the model has them."""
        for side, foot in zip(table.SIDES, feet, strict=True):
            name = f"{side}_sole"
            known = name in self.names.frames or self.spec.site(name) is not None
            if foot is None and not (known and self.names.sole):
                theirs = self.spec.joint(self.joints[f"{side}_ankle_roll"]).parent.name
                raise ModelError(f"{self.path}: body '{theirs}', a foot, has no geom that touches the floor")
            if foot is not None and not known:
                w_x_y_z = [foot.quaternion[3], *foot.quaternion[:3]]
                self.spec.body(foot.body).add_site(name=name, pos=foot.place, quat=w_x_y_z)
        foot = feet[0]
        self.sole = self.names.sole or (foot.sole if foot is not None else self.sole)

    def _frames(self, base: Any) -> None:
        """Add the other frames; those of a limb that the robot lacks are left out, but for the camera's."""
        bodies = {"base_link": base, "torso": self._body(self.torso, "torso")}
        for link, ours in _JOINT.items():
            if ours in self.joints:
                bodies[link] = self.spec.joint(self.joints[ours]).parent
        bodies["neck"] = bodies.get("neck", bodies.get("head"))
        bodies["head"] = bodies.get("head", bodies["neck"])
        for side in table.SIDES:
            # The hand is what the last joint of the arm moves.
            names = (*table.ARM_JOINTS, table.SEVENTH)
            arm = [f"{side}_{name}" for name in names if f"{side}_{name}" in self.joints]
            bodies[f"{side}_wrist"] = self.spec.joint(self.joints[arm[-1]]).parent if arm else None
        frames = [*table.FRAMES, *_ankles()]
        if bodies["head"] is None:
            frames = [_on_torso(frame) if frame.name == table.CAMERA_FRAME else frame for frame in frames]
        for frame in frames:
            if frame.name in self.names.frames or bodies.get(frame.link) is not None:
                self._frame(frame, bodies)

    def _frame(self, frame: table.Frame, bodies: dict[str, Any]) -> None:
        """Add a site with the name of the frame."""
        place = self.names.frames.get(frame.name)
        if isinstance(place, str):
            site = self.spec.site(place)
            if site is None:
                raise ModelError(
                    f"{self.path}: no site '{place}' for '{frame.name}'{_near(place, self.sites)}"
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

    def _servos(self, mj: mujoco.MjModel) -> None:
        """Replace the actuators by position servos with our gains, by the weight on legs of their length.

        Their torque is what the model allows: of the joint, or of its actuator; what it does not limit has
        the limits of ours.
        """
        efforts = _efforts(mj)
        for actuator in list(self.spec.actuators):
            self.spec.delete(actuator)
        data = at_zero(mj)
        hip, ankle = (mj.joint(self.joints[f"l_{name}"]).id for name in ("hip_pitch", "ankle_roll"))
        length = float(data.xanchor[hip][2] - data.xanchor[ankle][2]) + table.ANKLE_HEIGHT
        carried = float(mj.body_subtreemass[mj.body(self.names.base).id]) * length
        share = min(max(carried / _OURS, _WEAKEST), _STRONGEST)
        if abs(share - 1) < 1e-3:
            share = 1.0
        for ours, theirs in self.joints.items():
            usual = _USUAL.get(ours, _OTHER)
            effort = efforts.get(theirs, usual.effort * share)
            joint = self.spec.joint(theirs)
            servo = self.spec.add_actuator(name=ours, target=theirs, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            servo.set_to_position(kp=usual.kp * share, kv=usual.kv * share)
            servo.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
            servo.forcerange = [-effort, effort]
            # Stiff servos shake light links.
            joint.armature = max(float(joint.armature), usual.armature * share)

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
        for side in table.SIDES:
            site = self.spec.site(f"{side}_sole")
            if (taken := self.spec.site(f"{side}_sole_touch")) is not None:
                self.spec.delete(taken)
            touch = site.parent.add_site(
                name=f"{side}_sole_touch",
                type=mujoco.mjtGeom.mjGEOM_BOX,
                pos=site.pos + np.array([self.sole.centre, 0.0, 0.0]),
                quat=site.quat,
                size=[self.sole.half_length + 0.01, self.sole.half_width + 0.01, 0.02],
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


_HEAD_HEIGHT = sum(link.origin[2] for link in table.LINKS if link.name in ("neck", "head"))  # above the torso


def _efforts(mj: mujoco.MjModel) -> dict[str, float]:
    """The torque [N m] that a model allows each joint, by name; joints without a limit are left out."""
    efforts: dict[str, float] = {}
    for number in range(mj.njnt):
        if mj.jnt_actfrclimited[number]:
            efforts[mj.joint(number).name] = float(mj.jnt_actfrcrange[number, 1])
    for number in range(mj.nu):
        if mj.actuator_trntype[number] != mujoco.mjtTrn.mjTRN_JOINT:
            continue
        gear = abs(float(mj.actuator_gear[number, 0]))
        is_motor = mj.actuator_biastype[number] == mujoco.mjtBias.mjBIAS_NONE
        if mj.actuator_forcelimited[number]:
            most = float(mj.actuator_forcerange[number, 1]) * gear
        elif is_motor and mj.actuator_ctrllimited[number]:
            gain = abs(float(mj.actuator_gainprm[number, 0]))
            most = float(mj.actuator_ctrlrange[number, 1]) * gain * gear
        else:
            continue
        name = mj.joint(mj.actuator_trnid[number, 0]).name
        efforts[name] = min(most, efforts.get(name, most))
    return efforts


def _on_torso(frame: table.Frame) -> table.Frame:
    """A frame of the head, on the torso of a robot without one, at the same height."""
    x, y, z = frame.origin
    return table.Frame(frame.name, "torso", (x, y, z + _HEAD_HEIGHT), frame.rpy)


def _ankles() -> tuple[table.Frame, ...]:
    return tuple(table.Frame(f"{side}_ankle", f"{side}_ankle", (0.0, 0.0, 0.0)) for side in table.SIDES)


def _near(name: str, elements: Iterable[Any]) -> str:
    """A suggestion of what may have been meant."""
    close = difflib.get_close_matches(name, [element.name for element in elements if element.name], n=1)
    return f"; did you mean '{close[0]}'?" if close else ""

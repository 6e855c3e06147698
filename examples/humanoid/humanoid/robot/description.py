"""A compiled model as URDF, for robot_description of somebody else's robot.

Joints have our names, as in joint states; links have the names of the bodies, but for base_link. Capsules
and ellipsoids look like cylinders and spheres, and collide so. Meshes have no file that a URDF could name:
a body of meshes looks like what collides in their place, or like the boxes around them; a comment says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal
from xml.etree import ElementTree

import mujoco
import numpy as np

from ..spatial import Array, matrix_of
from . import table
from .model import HumanoidModel
from .urdf import TOP_SPEED, geometry, looks
from .xmltext import add, document

_HIDDEN = 3  # geoms of this group and above are not shown in MuJoCo
_CYLINDER = mujoco.mjtGeom.mjGEOM_CYLINDER
_KINDS: dict[int, Literal["box", "capsule", "ellipsoid", "sphere"]] = {
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(_CYLINDER): "capsule",  # whose length is that of the cylinder in its middle
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
}


def describe_robot(model: HumanoidModel) -> str:
    """Return the robot of a model as URDF text; what stands around it is left out."""
    return _Description(model).text()


@dataclass(frozen=True, slots=True)
class _Pose:
    """A place (3,) and a rotation matrix, in the axes of something else."""

    place: Array
    turn: Array

    def then(self, inner: _Pose) -> _Pose:
        """The pose of what is at `inner` in the axes of this pose."""
        return _Pose(self.place + self.turn @ inner.place, self.turn @ inner.turn)

    @staticmethod
    def of(place: Array, quaternion: Array) -> _Pose:
        """From MuJoCo's arrays; its quaternion is (w, x, y, z)."""
        w, x, y, z = quaternion
        return _Pose(np.array(place), matrix_of(np.array([x, y, z, w])))

    def add_to(self, parent: ElementTree.Element) -> None:
        """Add an element `origin`."""
        r = self.turn
        pitch = math.asin(max(-1.0, min(1.0, -float(r[2, 0]))))
        rpy = (math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0]))
        add(parent, "origin", xyz=tuple(map(float, self.place)), rpy=rpy)


class _Description:
    """The document while it is written."""

    def __init__(self, model: HumanoidModel) -> None:
        self._model, self._mj = model, model.mj
        self._root = ElementTree.Element("robot", name=_name(model.mj))
        self._joints = dict(zip(model.joints.tolist(), model.body.joints, strict=True))
        self._links = {model.base: "base_link"}  # names by body
        # A link's frame is on the axis of its joint, so a body's frame may be elsewhere in it.
        self._shift: dict[int, Array] = {model.base: np.zeros(3)}

    def text(self) -> str:
        """The whole document."""
        mj, base = self._mj, self._model.base
        bodies = [body for body in range(mj.nbody) if mj.body_rootid[body] == base]
        for body in bodies:
            if body != base:
                self._connect(body)
            self._link(self._links[body], body)
        taken = set(self._links.values())
        for name, site in self._model.frames.items():
            if name not in taken:
                self._frame(name, site)
        return document(self._root)

    def _connect(self, body: int) -> None:
        """Add the joints between a body and its parent, with a link without mass between two joints."""
        mj, name = self._mj, self._link_name(body)
        parent = int(mj.body_parentid[body])
        above = self._links[parent]
        place = _Pose(-self._shift[parent], np.eye(3)).then(_Pose.of(mj.body_pos[body], mj.body_quat[body]))
        shift = np.zeros(3)
        first = int(mj.body_jntadr[body])
        joints = range(first, first + int(mj.body_jntnum[body]))
        for number in joints:
            anchor = np.array(mj.jnt_pos[number])
            below = name if number == joints[-1] else f"{name}_{number}"
            self._joint(number, above, below, place.then(_Pose(anchor - shift, np.eye(3))))
            if below != name:
                add(self._root, "link", name=below)
            above, place, shift = below, _Pose(np.zeros(3), np.eye(3)), anchor
        if not joints:
            fixed = add(self._root, "joint", name=f"{name}_fixed", type="fixed")
            _between(fixed, above, name, place)
        self._links[body], self._shift[body] = name, shift

    def _joint(self, number: int, parent: str, child: str, place: _Pose) -> None:
        mj = self._mj
        turns = mj.jnt_type[number] == mujoco.mjtJoint.mjJNT_HINGE
        ours = self._joints[number]
        joint = add(self._root, "joint", name=ours, type="revolute" if turns else "prismatic")
        _between(joint, parent, child, place)
        add(joint, "axis", xyz=tuple(map(float, mj.jnt_axis[number])))
        lower, upper = map(float, mj.jnt_range[number])
        effort = float(self._model.effort[self._model.body.index(ours)])
        add(joint, "limit", lower=lower, upper=upper, effort=effort, velocity=TOP_SPEED)
        dof = int(mj.jnt_dofadr[number])
        damping, friction = float(np.ravel(mj.dof_damping[dof])[0]), float(mj.dof_frictionloss[dof])
        add(joint, "dynamics", damping=damping, friction=friction)

    def _link(self, name: str, body: int) -> None:
        """Add the link of a body: mass, looks and what collides."""
        mj = self._mj
        link = add(self._root, "link", name=name)
        back = _Pose(-self._shift[body], np.eye(3))
        if mj.body_mass[body] > 0:
            inertial = add(link, "inertial")
            back.then(_Pose.of(mj.body_ipos[body], mj.body_iquat[body])).add_to(inertial)
            add(inertial, "mass", value=float(mj.body_mass[body]))
            xx, yy, zz = map(float, mj.body_inertia[body])
            add(inertial, "inertia", ixx=xx, ixy=0.0, ixz=0.0, iyy=yy, iyz=0.0, izz=zz)
        geoms = [geom for geom in range(mj.ngeom) if mj.geom_bodyid[geom] == body]
        simple = [geom for geom in geoms if mj.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH]
        # A body of meshes looks like what collides in their place, if there is something.
        shown = [geom for geom in simple if mj.geom_group[geom] < _HIDDEN] or simple or geoms
        for geom in geoms:
            shape, place = self._shape(geom)
            place = back.then(place)
            if mj.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
                mesh = mj.mesh(int(mj.geom_dataid[geom])).name
                link.append(ElementTree.Comment(f" the box around the mesh {mesh} "))
            if geom in shown:
                for part in [shape] if mj.geom_type[geom] == _CYLINDER else looks(shape):
                    visual = add(link, "visual")
                    place.then(_Pose(np.array(part.position), np.eye(3))).add_to(visual)
                    geometry(add(visual, "geometry"), part)
                    material = add(visual, "material", name=f"{name}_{geom}")
                    add(material, "color", rgba=(*part.colour, 1.0))
            if mj.geom_contype[geom] or mj.geom_conaffinity[geom]:
                collision = add(link, "collision")
                place.add_to(collision)
                geometry(add(collision, "geometry"), shape)

    def _shape(self, geom: int) -> tuple[table.Shape, _Pose]:
        """A geom as a shape of the table, and its pose in its body."""
        mj = self._mj
        place = _Pose.of(mj.geom_pos[geom], mj.geom_quat[geom])
        red, green, blue, _ = self._colour(geom)
        x, y, z = map(float, mj.geom_size[geom])
        kind = _KINDS.get(int(mj.geom_type[geom]))
        if kind is None:  # a mesh: the box around it
            kind = "box"
            place = place.then(_Pose(np.array(mj.geom_aabb[geom, :3]), np.eye(3)))
            x, y, z = map(float, mj.geom_aabb[geom, 3:])
        return table.Shape(kind, (x, y, z), 0.0, (red, green, blue)), place

    def _colour(self, geom: int) -> Iterator[float]:
        material = int(self._mj.geom_matid[geom])
        rgba = self._mj.geom_rgba[geom] if material < 0 else self._mj.mat_rgba[material]
        return map(float, rgba)

    def _frame(self, name: str, site: int) -> None:
        mj = self._mj
        body = int(mj.site_bodyid[site])
        add(self._root, "link", name=name)
        joint = add(self._root, "joint", name=f"{name}_fixed", type="fixed")
        place = _Pose(-self._shift[body], np.eye(3)).then(_Pose.of(mj.site_pos[site], mj.site_quat[site]))
        _between(joint, self._links[body], name, place)

    def _link_name(self, body: int) -> str:
        name = str(self._mj.body(body).name) or f"body_{body}"
        return f"{name}_{body}" if name in self._links.values() else name


def _between(joint: ElementTree.Element, parent: str, child: str, place: _Pose) -> None:
    add(joint, "parent", link=parent)
    add(joint, "child", link=child)
    place.add_to(joint)


def _name(mj: mujoco.MjModel) -> str:
    """The name that the model has."""
    return bytes(mj.names).split(b"\0", 1)[0].decode() or "robot"

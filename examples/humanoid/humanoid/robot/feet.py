"""Where the soles of a robot are: the flat underside of whatever its feet collide with."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from ..spatial import Array, quaternion_of
from .measuring import at_zero
from .model import SoleGeometry

_FLAT = 0.01  # metres above the lowest point of a foot that still belong to its sole


@dataclass(frozen=True, slots=True)
class Foot:
    """A sole: its frame in a body, level when all joints are at zero, below the ankle; and its rectangle."""

    body: str
    place: Array  # (3,)
    quaternion: Array  # (4,)
    sole: SoleGeometry


def measured_foot(mj: mujoco.MjModel, ankle: str) -> Foot | None:
    """The foot that a joint moves; None if nothing of it collides."""
    data = at_zero(mj)
    joint = mj.joint(ankle)
    body = int(joint.bodyid[0])
    rigid = mj.body_weldid == mj.body_weldid[body]
    solid = (mj.geom_contype != 0) | (mj.geom_conaffinity != 0)
    geoms = np.flatnonzero(rigid[mj.geom_bodyid] & solid).tolist()
    points = np.array([point for geom in geoms for point in _underside(mj, data, geom)])
    if not points.size:
        return None
    lowest = float(points[:, 2].min())
    flat = points[points[:, 2] < lowest + _FLAT]
    (back, right), (front, left) = flat[:, :2].min(axis=0).tolist(), flat[:, :2].max(axis=0).tolist()
    x = float(data.xanchor[joint.id][0])
    sole = SoleGeometry((back + front) / 2 - x, (front - back) / 2, (left - right) / 2)
    turn: Array = data.xmat[body].reshape(3, 3).T
    place = turn @ (np.array([x, (left + right) / 2, lowest]) - data.xpos[body])
    return Foot(mj.body(body).name, place, quaternion_of(turn), sole)


def _underside(mj: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Iterator[Array]:
    """Points (3,) of a geom that may touch a floor below."""
    centre, turn = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    kind, size = mj.geom_type[geom], mj.geom_size[geom]
    down = np.array([0.0, 0.0, -size[0]])
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        yield centre + down
    elif kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        for end in (-size[1], size[1]):
            yield centre + turn[:, 2] * end + down
    elif kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = mj.geom_dataid[geom]
        first = mj.mesh_vertadr[mesh]
        yield from centre + mj.mesh_vert[first : first + mj.mesh_vertnum[mesh]] @ turn.T
    else:
        middle, half = mj.geom_aabb[geom, :3], mj.geom_aabb[geom, 3:]
        for corner in product((-1, 1), repeat=3):
            yield centre + turn @ (middle + half * np.array(corner))

"""A map of the floor from pictures of a camera whose place is known.

What has a strong colour is an obstacle, and stands where its lower edge meets the floor: the ray through
that edge gives the place. Grey pixels below are floor. What is behind an obstacle cannot be seen; it is taken
to be as deep as it is wide.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from ..robot.grid import FREE, OCCUPIED, UNKNOWN, Grid
from ..robot.model import HumanoidModel
from ..robot.table import CAMERA_FRAME
from ..spatial import Array
from .camera import Lens, Picture

_COLOURED, _GREY = 0.45, 0.35  # saturation from which something is an obstacle, and up to which it is floor
_DARK = 20  # of 255: nothing darker has a colour
_EDGE = 2  # pixels at the sides of an obstacle that are blurred, and of its least height
_STEEP = -0.05  # vertical part of a ray that meets the floor, per metre of its length
_HIT, _MISS, _FAR_HIT, _BEHIND = 45.0, -25.0, 25.0, 25.0  # evidence of one picture
_FAR = 2.5  # m from which an obstacle needs two pictures
_AROUND = 3  # cells around an occupied one that may hold the same obstacle
_LEVEL = 0.1  # share of a ray that must be ahead
_WIDTH, _HEIGHT, _FOCAL, _HORIZON = 200, 145, 91.0, 9.0  # of the levelled picture, in pixels
_MOST, _OCCUPIED = 100.0, 20.0
_NEARER = 0.35  # m: how much nearer an obstacle may be than the edge of the picture that cuts it
_DEPTHS = (0.15, 0.35)  # m: least and most that an obstacle is taken to be deep


Mask = NDArray[np.bool_]
Floats = NDArray[np.floating[Any]]
_Cells = tuple[NDArray[np.intp], NDArray[np.intp]]


class Viewpoint(NamedTuple):
    """Where a camera is: position (3,) and rotation (3, 3) of its optical frame, in odom."""

    position: Array
    rotation: Array


class Viewpoints:
    """Where the head camera is, from the pose of base_link and the joints."""

    def __init__(self, model: HumanoidModel) -> None:
        self._model, self._data = model, model.data()
        self._site = model.frames[CAMERA_FRAME]

    def of(self, position: Array, orientation: Array, joints: Array) -> Viewpoint:
        """The camera's place for base_link's position (3,) and quaternion (4,), and the joints (29,)."""
        x, y, z, w = orientation
        self._data.qpos[:3] = position
        self._data.qpos[3:7] = (w, x, y, z)
        self._data.qpos[self._model.qpos] = joints
        mujoco.mj_kinematics(self._model.mj, self._data)
        rotation = self._data.site_xmat[self._site].reshape(3, 3).copy()
        return Viewpoint(self._data.site_xpos[self._site].copy(), rotation)


class FloorMap:
    """Collects what pictures say about each cell of the floor."""

    def __init__(self, half_size: float = 6.0, resolution: float = 0.05) -> None:
        self._resolution, self._corner = resolution, -half_size
        self._size = round(2 * half_size / resolution)
        self._evidence = np.zeros((self._size, self._size))
        self._seen = np.zeros((self._size, self._size), dtype=np.int64) - 1  # when [ns]; -1: never

    @property
    def grid(self) -> Grid:
        """The map."""
        cells = np.where(self._evidence > _OCCUPIED, OCCUPIED, FREE).astype(np.int8)
        cells[self._seen < 0] = UNKNOWN
        return Grid(self._resolution, self._corner, self._corner, cells)

    def see(
        self, stamp: int, picture: Picture, lens: Lens, viewpoint: Viewpoint, reach: float, memory: int
    ) -> None:
        """Add what a picture shows within `reach` [m]; forget what was not seen for `memory` [ns]."""
        if np.hypot(*viewpoint.rotation[:2, 2]) < _LEVEL:
            return
        picture, seen, lens, viewpoint = _levelled(picture, lens, viewpoint)
        coloured, grey = _kinds(picture)
        bases = _lower_edges(coloured & seen)
        floor = grey & seen & (np.arange(lens.height)[:, None] > bases[None, :])
        rows, columns = np.nonzero(floor)
        free = self._cells(_on_floor(lens, viewpoint, columns + 0.5, rows + 0.5, reach))
        hits, far, behind = self._obstacles(lens, viewpoint, bases, seen, reach)
        change = np.zeros_like(self._evidence)
        change[free] = _MISS
        change[behind] = np.maximum(change[behind], 0.0)
        change[far] = _FAR_HIT
        change[hits] = _HIT
        self._evidence = np.clip(self._evidence + change, -_MOST / 2, _MOST)
        self._evidence[behind] = np.maximum(self._evidence[behind], _BEHIND)
        for cells in (free, hits, far, behind):
            self._seen[cells] = stamp
        old = (self._seen >= 0) & (self._seen < stamp - memory) & (self._evidence > _OCCUPIED)
        self._evidence[old], self._seen[old] = 0.0, -1

    def _obstacles(
        self, lens: Lens, viewpoint: Viewpoint, bases: NDArray[np.intp], seen: Mask, reach: float
    ) -> tuple[_Cells, _Cells, _Cells]:
        """The cells where obstacles begin, near and far, and those behind, which nobody sees."""
        near: list[Array] = []
        far: list[Array] = []
        behind: list[Array] = []
        foot = viewpoint.position[:2]
        columns = np.nonzero(bases >= 0)[0]
        rows = bases[columns]
        points = _on_floor(lens, viewpoint, columns + 0.5, rows + 1.0, np.inf)
        # An obstacle that the picture's edge cuts is at most as far away as that edge: of use only if the map
        # does not know it yet.
        cut = ~seen[np.minimum(rows + 1, lens.height - 1), columns]
        points[cut] = np.where(self._is_between(foot, points[cut])[:, None], np.nan, points[cut])
        behind += self._before(foot, points[cut])
        for group in _groups(columns, points):
            away = group - foot
            distance = np.hypot(away[:, 0], away[:, 1])
            close = distance <= reach
            if not close.any():
                continue
            near.append(group[close & (distance < _FAR)])
            far.append(group[close & (distance >= _FAR)])
            width = float(np.hypot(*(group[-1] - group[0])))
            depths = np.arange(self._resolution, min(max(width, _DEPTHS[0]), _DEPTHS[1]), self._resolution)
            direction = away[close] / distance[close][:, None]
            behind += [group[close] + direction * depth for depth in depths]
        return self._cells(_joined(near)), self._cells(_joined(far)), self._cells(_joined(behind))

    def _before(self, foot: Array, points: Array) -> list[Array]:
        """Places nearer than points (n, 2) where an obstacle may begin whose lower edge is not seen."""
        away = points[np.isfinite(points).all(axis=1)] - foot
        distance = np.hypot(away[:, 0], away[:, 1])[:, None]
        steps = np.arange(self._resolution, _NEARER, self._resolution)
        return [foot + away * (1.0 - np.minimum(step / distance, 0.5)) for step in steps] if len(away) else []

    def _known(self) -> Mask:
        """The occupied cells and those around them."""
        occupied = np.pad(self._evidence > _OCCUPIED, _AROUND)
        known = np.zeros_like(self._evidence, dtype=np.bool_)
        for row in range(2 * _AROUND + 1):
            for column in range(2 * _AROUND + 1):
                known |= occupied[row : row + self._size, column : column + self._size]
        return known

    def _is_between(self, foot: Array, points: Array) -> Mask:
        """Whether something known is between the robot and each of the points (n, 2)."""
        known = self._known()
        found = np.zeros(len(points), dtype=np.bool_)
        for share in np.linspace(0.2, 1.0, 25):
            places = ((foot + share * (points - foot) - self._corner) // self._resolution).astype(int)
            rows, columns = np.clip(places[:, 1], 0, self._size - 1), np.clip(places[:, 0], 0, self._size - 1)
            found |= known[rows, columns]
        return found

    def _cells(self, points: Array) -> _Cells:
        """The cells at points (n, 2), without those beyond the map."""
        places = ((points - self._corner) // self._resolution).astype(int)
        inside = ((places >= 0) & (places < self._size)).all(axis=1)
        return places[inside, 1], places[inside, 0]


def _levelled(picture: Picture, lens: Lens, viewpoint: Viewpoint) -> tuple[Picture, Mask, Lens, Viewpoint]:
    """The picture as a camera at the same place would see it that looks at the horizon.

    There, what stands upright is upright, so that the lower edge of an obstacle is where it stands. The mask
    has the pixels that the picture shows.
    """
    x, y = viewpoint.rotation[:2, 2] / np.hypot(*viewpoint.rotation[:2, 2])
    rotation = np.array([[y, 0.0, x], [-x, 0.0, y], [0.0, -1.0, 0.0]])
    level = Lens(_WIDTH, _HEIGHT, _FOCAL, _WIDTH / 2, _HORIZON)
    rows, columns = np.mgrid[:_HEIGHT, :_WIDTH] + 0.5
    rays = np.stack([(columns - level.x) / _FOCAL, (rows - level.y) / _FOCAL, np.ones_like(rows)], axis=2)
    rays = rays @ (viewpoint.rotation.T @ rotation).T
    ahead = np.maximum(rays[..., 2], 1e-6)
    u = np.floor(lens.x + lens.focal * rays[..., 0] / ahead).astype(int)
    v = np.floor(lens.y + lens.focal * rays[..., 1] / ahead).astype(int)
    seen = (rays[..., 2] > _LEVEL) & (u >= 0) & (u < lens.width) & (v >= 0) & (v < lens.height)
    shown = picture[np.where(seen, v, 0), np.where(seen, u, 0)]
    return shown, seen, level, Viewpoint(viewpoint.position, rotation)


def _kinds(picture: Picture) -> tuple[Mask, Mask]:
    """The pixels of obstacles and those of the floor, each (height, width)."""
    red, green, blue = (picture[..., plane].astype(np.int16) for plane in range(3))
    strongest, weakest = np.maximum(np.maximum(red, green), blue), np.minimum(np.minimum(red, green), blue)
    saturation = (strongest - weakest) / np.maximum(strongest, 1)
    bluish = (blue == strongest) & (green > red)  # the robot's own arms, and the sky
    return (saturation > _COLOURED) & (strongest > _DARK) & ~bluish, saturation < _GREY


def _lower_edges(coloured: Mask) -> NDArray[np.intp]:
    """The lowest row (width,) in which each column shows an obstacle; -1: none.

    What stands behind, in the same column, is not looked for: its own lower edge is hidden.
    """
    inner = coloured.copy()
    for shift in range(1, 1 + _EDGE):
        inner[:, shift:] &= coloured[:, :-shift]
        inner[:, :-shift] &= coloured[:, shift:]
        inner[shift:] &= coloured[:-shift]
    rows = np.arange(coloured.shape[0])[:, None]
    lowest: NDArray[np.intp] = np.where(inner, rows, -1).max(axis=0)
    return lowest


def _on_floor(lens: Lens, viewpoint: Viewpoint, u: Floats, v: Floats, reach: float) -> Array:
    """Where the rays through points of the image meet the floor, (n, 2), within a distance [m]."""
    rays = np.stack([(u - lens.x) / lens.focal, (v - lens.y) / lens.focal, np.ones_like(u)], axis=1)
    rays = rays @ viewpoint.rotation.T
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    steep = rays[:, 2] < _STEEP
    scale = np.where(steep, -viewpoint.position[2] / np.where(steep, rays[:, 2], -1.0), np.inf)
    with np.errstate(invalid="ignore"):
        offsets = rays[:, :2] * scale[:, None]
    if np.isfinite(reach):
        offsets = offsets[steep & (np.hypot(offsets[:, 0], offsets[:, 1]) <= reach)]
    points: Array = viewpoint.position[:2] + offsets
    return points


def _groups(columns: NDArray[np.intp], points: Array) -> list[Array]:
    """Points of neighbouring columns that are near each other, as arrays (n, 2)."""
    finite = np.isfinite(points).all(axis=1)
    columns, points = columns[finite], points[finite]
    if not len(columns):
        return []
    steps = np.hypot(*(points[1:] - points[:-1]).T)
    return np.split(points, np.nonzero((np.diff(columns) > 1) | (steps > 0.3))[0] + 1)


def _joined(parts: list[Array]) -> Array:
    return np.concatenate(parts) if parts else np.zeros((0, 2))

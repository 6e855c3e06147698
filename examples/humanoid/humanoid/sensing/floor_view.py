"""What one picture shows of the floor: where it is free, and where something stands on it.

What has a strong colour is an obstacle, and stands where its lower edge meets the floor: the ray through
that edge gives the place. Grey pixels are floor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from ..robot.model import HumanoidModel
from ..robot.table import CAMERA_FRAME
from ..spatial import Array
from .camera import Lens, Picture
from .regions import Region, label_regions

_COLOURED, _GREY = 0.45, 0.35  # saturation from which something is an obstacle, and up to which it is floor
_DARK = 20  # of 255: nothing darker has a colour
_OTHER = 0.25  # how far apart two colours of one obstacle may be; the strongest part of each is 1
_SMALLEST = 12  # pixels
_LEVEL = 0.1  # share of a ray that must be ahead
_WIDTH, _HEIGHT, _FOCAL, _HORIZON = 200, 145, 91.0, 9.0  # of the levelled picture, in pixels

Mask = NDArray[np.bool_]


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


@dataclass(frozen=True, slots=True)
class Sighting:
    """An obstacle in a picture; places (n, 2) in odom.

    `front`: where it stands, as far as its lower edge is seen. `cut`: where it is hidden by the picture's
    edge, so that it begins there or nearer. `ends`: for each place of `front`, then of `cut`, how far away
    it hides the floor [m from the camera; infinite above the horizon].
    """

    front: Array
    cut: Array
    ends: Array


class FloorView:
    """A picture as a camera at the same place would see it that looks at the horizon.

    There, what stands upright is upright, so that the lower edge of an obstacle is where it stands.
    """

    def __init__(self, picture: Picture, lens: Lens, viewpoint: Viewpoint) -> None:
        """Turn a picture. Raises ValueError if the camera looks straight down or up."""
        ahead = float(np.hypot(*viewpoint.rotation[:2, 2]))
        if ahead < _LEVEL:
            raise ValueError("a camera that looks straight down or up sees no horizon")
        x, y = viewpoint.rotation[:2, 2] / ahead
        self._rotation = np.array([[y, 0.0, x], [-x, 0.0, y], [0.0, -1.0, 0.0]])
        self.position = viewpoint.position
        rows, columns = np.mgrid[:_HEIGHT, :_WIDTH] + 0.5
        rays = np.stack(
            [(columns - _WIDTH / 2) / _FOCAL, (rows - _HORIZON) / _FOCAL, np.ones_like(rows)], axis=2
        )
        rays = rays @ (viewpoint.rotation.T @ self._rotation).T
        depth = np.maximum(rays[..., 2], 1e-6)
        u = np.floor(lens.x + lens.focal * rays[..., 0] / depth).astype(int)
        v = np.floor(lens.y + lens.focal * rays[..., 1] / depth).astype(int)
        self._seen = (rays[..., 2] > _LEVEL) & (u >= 0) & (u < lens.width) & (v >= 0) & (v < lens.height)
        shown = picture[np.where(self._seen, v, 0), np.where(self._seen, u, 0)]
        self._coloured, grey, colours = _kinds(shown)
        self._coloured &= self._seen
        self._floor = grey & self._seen & ~_widened(self._coloured)
        other = np.abs(np.diff(colours, axis=0)).max(axis=2) > _OTHER
        self._parts = self._coloured.copy()
        self._parts[:-1] &= ~(other & self._coloured[1:])

    def floor_at(self, places: Array, height: float | Array = 0.0) -> Mask:
        """Whether floor is seen where places (n, 2) are, or something above them would be [m] (n,)."""
        return self._at(self._floor, places, height)

    def covered(self, places: Array) -> Mask:
        """Whether an obstacle is, or hides, what is at places (n, 2) of the floor."""
        return self._at(self._coloured, places, 0.0)

    def sightings(self) -> list[Sighting]:
        """The obstacles in the picture."""
        labels, regions = label_regions(self._parts)
        found = (self._sighting(labels, region) for region in regions if region.area >= _SMALLEST)
        return [sighting for sighting in found if len(sighting.front) or len(sighting.cut)]

    def _sighting(self, labels: NDArray[np.intp], region: Region) -> Sighting:
        top, left, bottom, right = region.box
        own = labels[top:bottom, left:right] == region.label
        if right - left > 4:  # its sides are blurred
            own, left = own[:, 1:-1], left + 1
        columns = np.nonzero(own.any(axis=0))[0]
        lowest = top + own.shape[0] - 1 - own[::-1].argmax(axis=0)[columns]
        highest = top + own.argmax(axis=0)[columns]
        columns = columns + left
        below = np.minimum(lowest + 1, _HEIGHT - 1)
        cut = ~self._seen[below, columns]
        stands = ~cut & ~self._coloured[below, columns]
        points, ends = self._on_floor(columns, lowest + 1.0), self._on_floor(columns, highest)
        order = np.concatenate([np.nonzero(stands)[0], np.nonzero(cut)[0]])
        distances = np.hypot(*(ends[order] - self.position[:2]).T)
        return Sighting(points[stands], points[cut], distances)

    def _at(self, mask: Mask, places: Array, height: float | Array) -> Mask:
        offsets = np.empty((len(places), 3))
        offsets[:, :2] = places - self.position[:2]
        offsets[:, 2] = height - self.position[2]
        seen = offsets @ self._rotation
        ahead = seen[:, 2] > _LEVEL
        depth = np.where(ahead, seen[:, 2], 1.0)
        columns = np.floor(_WIDTH / 2 + _FOCAL * seen[:, 0] / depth).astype(int)
        rows = np.floor(_HORIZON + _FOCAL * seen[:, 1] / depth).astype(int)
        inside = ahead & (columns >= 0) & (columns < _WIDTH) & (rows >= 0) & (rows < _HEIGHT)
        found: Mask = inside & mask[np.where(inside, rows, 0), np.where(inside, columns, 0)]
        return found

    def _on_floor(self, columns: NDArray[np.intp], rows: NDArray[Any]) -> Array:
        """Where the rays through the middles of columns at the upper edges of rows meet the floor (n, 2)."""
        down = (rows - _HORIZON) / _FOCAL
        depth = np.where(down > 1e-3, self.position[2] / np.maximum(down, 1e-3), np.inf)
        aside = (columns + 0.5 - _WIDTH / 2) / _FOCAL
        with np.errstate(invalid="ignore"):  # straight ahead, infinity has no side
            offsets = np.stack([aside * depth, np.zeros_like(depth), depth], axis=1) @ self._rotation[:2].T
        points: Array = self.position[:2] + np.where(np.isfinite(depth)[:, None], offsets, np.inf)
        return points


def _kinds(picture: Picture) -> tuple[Mask, Mask, NDArray[np.float32]]:
    """The pixels of obstacles, those of the floor, each (height, width), and their colours."""
    parts = picture.astype(np.float32)
    red, green, blue = (parts[..., plane] for plane in range(3))
    strongest, weakest = parts.max(axis=2), parts.min(axis=2)
    saturation = (strongest - weakest) / np.maximum(strongest, 1)
    bluish = (blue == strongest) & (green > red)  # the robot's own arms, and the sky
    coloured = (saturation > _COLOURED) & (strongest > _DARK) & ~bluish
    return coloured, saturation < _GREY, parts / np.maximum(strongest, 1)[..., None]


def _widened(mask: Mask) -> Mask:
    """A mask with a pixel more on each side."""
    wide = mask.copy()
    wide[1:] |= mask[:-1]
    wide[:-1] |= mask[1:]
    higher = wide.copy()
    wide[:, 1:] |= higher[:, :-1]
    wide[:, :-1] |= higher[:, 1:]
    return wide

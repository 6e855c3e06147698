"""A map of the floor from pictures of a camera whose place is known.

Where an obstacle begins is seen; how deep it is cannot be. It is taken to be as deep as it is wide, until the
floor behind it is seen. Floor that is seen is free, and so is a place where the camera looks through what
would stand there. What cannot be seen stays as it was, for a while.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..robot.grid import FREE, OCCUPIED, UNKNOWN, Grid, nearest
from ..spatial import Array
from .camera import Lens, Picture
from .floor_view import FloorView, Sighting, Viewpoint

_HIT, _FAR_HIT, _MISS, _GUESS = 45.0, 25.0, -25.0, 15.0  # evidence of one picture
_MOST, _LEAST, _OCCUPIED, _AT_ONCE = 100.0, -50.0, 20.0, 25.0
_REFUTED = -10.0  # evidence below which a guess needs more than one picture
_FAR = 2.5  # m from which an obstacle needs two pictures
_NARROWEST, _DEEPEST = 0.15, 0.5  # m: what an obstacle is taken to be
_JUMP = 0.3  # m between neighbouring columns of a picture that are two obstacles
_NEARER = 0.5  # m: how much nearer an obstacle may be than the edge of the picture that cuts it
_AROUND = 0.05  # m around an occupied cell that may belong to the same obstacle
_SURELY = 0.9  # share of the height that hides the floor, where the camera must not see any
_LEAST_END = 0.2  # of the columns of a picture: the others hide more

_Cells = tuple[NDArray[np.intp], NDArray[np.intp]]


class FloorMap:
    """Collects what pictures say about each cell of the floor."""

    def __init__(self, half_size: float = 6.0, resolution: float = 0.05) -> None:
        self._resolution, self._corner = resolution, -half_size
        self._size = round(2 * half_size / resolution)
        self._evidence = np.zeros((self._size, self._size))
        self._height = np.zeros((self._size, self._size))  # that what stands there has at least [m]
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
        """Add what a picture shows within `reach` [m]; forget what was not seen for `memory` [ns].

        Raises ValueError if the camera looks straight down or up.
        """
        view = FloorView(picture, lens, viewpoint)
        free = self._free(view, reach)
        self._evidence[free] = np.maximum(self._evidence[free] + _MISS, _LEAST)
        self._seen[free] = stamp
        for sighting in view.sightings():
            self._add(sighting, view, stamp, reach)
        old = (self._seen >= 0) & (self._seen < stamp - memory) & (self._evidence > _OCCUPIED)
        self._evidence[old], self._seen[old] = 0.0, -1

    def _free(self, view: FloorView, reach: float) -> _Cells:
        """The cells where floor is seen, and those where it would not be if something stood there."""
        low = np.clip((view.position[:2] - reach - self._corner) // self._resolution, 0, self._size)
        high = np.clip((view.position[:2] + reach - self._corner) // self._resolution + 1, 0, self._size)
        (left, bottom), (right, top) = low.astype(int), high.astype(int)
        rows, columns = (part.ravel() for part in np.mgrid[bottom:top, left:right])
        places = self._middles(rows, columns)
        near = np.hypot(*(places - view.position[:2]).T) <= reach
        rows, columns, places = rows[near], columns[near], places[near]
        free = view.floor_at(places)
        solid = self._evidence[rows, columns] > _OCCUPIED
        free[solid] |= view.floor_at(places[solid], self._height[rows[solid], columns[solid]])
        return rows[free], columns[free]

    def _add(self, sighting: Sighting, view: FloorView, stamp: int, reach: float) -> None:
        """Add an obstacle: where it begins, and what it is taken to fill."""
        foot = view.position[:2]
        distance = np.hypot(*(sighting.front - foot).T)
        front, near = sighting.front[distance <= reach], distance[distance <= reach] < _FAR
        added = np.zeros_like(self._evidence)
        added[self._cells(front[~near])] = _FAR_HIT
        added[self._cells(front[near])] = _HIT
        at_once = np.zeros_like(added, dtype=np.bool_)
        at_once[self._cells(front[near])] = True
        for part in _parts(front):
            places = _body(part, foot, self._resolution / 2)
            hidden = self._cells(places[view.covered(places)])
            added[hidden] = np.maximum(added[hidden], _GUESS)
            at_once[hidden] |= near.all() & (self._evidence[hidden] > _REFUTED)
        at_once[self._cells(self._nearer(foot, sighting.cut, reach))] = True
        cells = np.nonzero((added > 0) | at_once)
        known = self._evidence[cells] > _OCCUPIED
        evidence = self._evidence[cells] + added[cells]
        evidence[at_once[cells]] = np.maximum(evidence[at_once[cells]], _AT_ONCE)
        self._evidence[cells] = np.minimum(evidence, _MOST)
        height = _SURELY * _height(self._middles(*cells), sighting, view)
        self._height[cells] = np.where(known, np.minimum(self._height[cells], height), height)
        self._seen[cells] = stamp

    def _nearer(self, foot: Array, cut: Array, reach: float) -> Array:
        """Places (n, 2) where an obstacle may begin that the picture's edge cuts at places (m, 2).

        None, if the map knows something between the robot and the edge.
        """
        cut = cut[np.hypot(*(cut - foot).T) <= reach]
        if not len(cut):
            return cut
        shares = np.linspace(0.2, 1.0, 25)
        between = (foot + shares[:, None, None] * (cut - foot)).reshape(-1, 2)
        known = nearest(self.grid.occupied(), between).reshape(len(shares), -1).min(axis=0) < _AROUND
        away = cut[~known] - foot
        distance = np.hypot(*away.T)[:, None]
        steps = np.arange(0.0, _NEARER, self._resolution)
        return np.concatenate([foot + away * (1.0 - np.minimum(step / distance, 0.5)) for step in steps])

    def _middles(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Array:
        """The middles (n, 2) of cells."""
        cells = np.stack([columns, rows], axis=1).astype(float)
        return self._corner + (cells + 0.5) * self._resolution

    def _cells(self, points: Array) -> _Cells:
        """The cells at points (n, 2), without those beyond the map."""
        places = ((points - self._corner) // self._resolution).astype(int)
        inside = ((places >= 0) & (places < self._size)).all(axis=1)
        return places[inside, 1], places[inside, 0]


def _height(places: Array, sighting: Sighting, view: FloorView) -> Array:
    """How high something at each of the places (n, 2) must be to hide as much of the floor as it does."""
    distance = np.hypot(*(places - view.position[:2]).T)
    end = float(np.quantile(sighting.ends, _LEAST_END, method="lower"))
    heights: Array = view.position[2] * np.maximum(1.0 - distance / end, 0.0)
    return heights


def _parts(front: Array) -> list[Array]:
    """The front of what looks like one obstacle, where it jumps: of two of one colour."""
    steps = np.hypot(*np.diff(front, axis=0).T)
    return [part for part in np.split(front, np.nonzero(steps > _JUMP)[0] + 1) if len(part)]


def _body(front: Array, foot: Array, step: float) -> Array:
    """Places (n, 2), a step apart, that an obstacle fills that is as deep as it is wide: a disc.

    It touches the front (m, 2), or its middle, if the front is round.
    """
    middle = (front[0] + front[-1]) / 2
    radius = max(float(np.hypot(*(front[-1] - front[0]))), _NARROWEST) / 2
    ahead = (middle - foot) / np.hypot(*(middle - foot))
    bulge = min(max(float(((middle - front) @ ahead).max()), 0.0), radius)
    centre = middle + ahead * (radius - bulge)
    side = np.arange(-radius, radius + step / 2, step)
    places = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    places = centre + places[np.hypot(*places.T) <= radius]
    filled: Array = places[(places - middle) @ ahead < _DEEPEST - bulge]
    return filled

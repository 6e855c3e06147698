"""A map of the floor in square cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..spatial import Array

FREE, OCCUPIED, UNKNOWN = 0, 100, -1


@dataclass(frozen=True, slots=True)
class Grid:
    """nav_msgs/OccupancyGrid without rotation: cell [row, column] begins at (x + column, y + row) cells."""

    resolution: float  # edge of a cell [m]
    x: float  # of the corner of the first cell, in odom [m]
    y: float
    cells: NDArray[np.int8]  # (rows, columns): 0 to 100, or -1 where nothing is known

    def occupied(self, threshold: int = OCCUPIED // 2) -> Array:
        """The middles (n, 2) of the cells from an occupancy on [m]."""
        rows, columns = np.nonzero(self.cells >= threshold)
        x, y = (self.x + (columns + 0.5) * self.resolution, self.y + (rows + 0.5) * self.resolution)
        return np.stack([x, y], axis=1)

    def at(self, x: float, y: float) -> int:
        """The value of the cell at a point; unknown beyond the map."""
        row, column = int((y - self.y) // self.resolution), int((x - self.x) // self.resolution)
        rows, columns = self.cells.shape
        return int(self.cells[row, column]) if 0 <= row < rows and 0 <= column < columns else UNKNOWN


def nearest(points: Array, places: Array) -> Array:
    """The distance of each place (m, 2) from the nearest of the points (n, 2); infinite if there is none."""
    if not len(points):
        return np.full(len(places), np.inf)
    offsets = places[:, None, :] - points[None, :, :]
    distances: Array = np.sqrt((offsets**2).sum(axis=2).min(axis=1))
    return distances

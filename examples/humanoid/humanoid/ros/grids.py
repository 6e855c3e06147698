"""Maps and paths as messages, and back."""

from __future__ import annotations

from array import array

import numpy as np
from geometry_msgs.msg import Pose
from nav_msgs.msg import MapMetaData, OccupancyGrid

from ..robot.grid import Grid
from . import messages


def occupancy_grid(grid: Grid, stamp: int) -> OccupancyGrid:
    """For /map, in odom."""
    rows, columns = grid.cells.shape
    origin = Pose(position=messages.point(grid.x, grid.y, 0.0))
    origin.orientation.w = 1.0
    info = MapMetaData(resolution=grid.resolution, width=columns, height=rows, origin=origin)
    return OccupancyGrid(
        header=messages.header(stamp, "odom"), info=info, data=array("b", grid.cells.tobytes())
    )


def read_occupancy_grid(message: OccupancyGrid) -> Grid:
    """From /map. Raises ValueError if it is turned, or its cells are not as many as it says."""
    rows, columns = message.info.height, message.info.width
    cells = np.array(message.data, dtype=np.int8)
    if cells.size != rows * columns or not message.info.resolution > 0:
        raise ValueError(f"{cells.size} cells are no map of {columns} x {rows}")
    x, y, yaw = (float(part) for part in messages.planar(message.info.origin))
    if abs(yaw) > 1e-6:
        raise ValueError("the map is turned against its frame")
    return Grid(float(message.info.resolution), x, y, cells.reshape(rows, columns))

"""Maps and paths as messages, and back."""

from __future__ import annotations

import itertools
import math
from array import array
from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import Pose
from nav_msgs.msg import MapMetaData, OccupancyGrid, Path

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
    try:
        x, y, yaw = messages.place_of(message.info.origin)
    except ValueError as error:
        raise ValueError(f"its origin {error}") from None
    if abs(yaw) > 1e-6:
        raise ValueError("the map is turned against its frame")
    return Grid(float(message.info.resolution), x, y, cells.reshape(rows, columns))


def path(places: Sequence[tuple[float, float]], yaw: float, stamp: int) -> Path:
    """Corners of a path in odom, each turned to the next one; the last one is turned by `yaw`."""
    turns = [math.atan2(there[1] - here[1], there[0] - here[0]) for here, there in itertools.pairwise(places)]
    poses = [
        messages.stamped(stamp, messages.planar_pose(x, y, turn))
        for (x, y), turn in zip(places, [*turns, yaw], strict=True)
    ]
    return Path(header=messages.header(stamp, "odom"), poses=poses)


def read_path(message: Path) -> tuple[tuple[tuple[float, float], ...], float]:
    """The corners of a path, and the yaw at its end. Raises ValueError if there are fewer than two."""
    planar = [messages.planar(pose.pose) for pose in message.poses]
    if len(planar) < 2:
        raise ValueError(f"a path needs a start and a goal; this one has {len(planar)} poses")
    if not np.isfinite(planar).all():
        raise ValueError("the path holds a number that is not finite")
    return tuple((float(x), float(y)) for x, y, _ in planar), float(planar[-1][2])

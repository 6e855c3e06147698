"""nav_msgs/msg/OccupancyGrid and numpy arrays of (height, width). Row 0 is at the origin."""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ifgen_runtime.errors import ConversionError
from ifgen_runtime.numpy.fields import (
    checked_size,
    copied,
    described,
    items_in,
    name_of,
    new_message,
    require,
    size_in,
)
from ifgen_runtime.numpy.messages import GridMessage

GridT = TypeVar("GridT", bound=GridMessage)

_GRID = "nav_msgs/msg/OccupancyGrid"
_INT8 = np.dtype(np.int8)


def grid_array(grid: GridMessage) -> NDArray[np.int8]:
    """View the cells of a nav_msgs/msg/OccupancyGrid without a copy, of shape (height, width).

    `cells[row, column]` is the cell whose lower corner is at x = column * resolution, y = row * resolution
    [m] from `info.origin`, along the axes of the map. So row 0 is at the bottom of a map that is drawn with
    y up; `cells[::-1]` has the order of the rows of an image. Values are 0 (free) to 100 (occupied), and -1
    (not known).

    Writing to the view writes to the grid. Raise ConversionError if `data` does not have height * width
    items.
    """
    require(grid, _GRID, "info", "data")
    path = f"{name_of(grid)}.info"
    height, width = size_in(grid.info, "height", path), size_in(grid.info, "width", path)
    cells = items_in(grid, "data", _INT8)
    if len(cells) != height * width:
        raise ConversionError(
            f"{name_of(grid)}.data", f"expected {height} x {width} = {height * width} cells, got {len(cells)}"
        )
    return cells.reshape(height, width)


def from_grid_array(
    cls: type[GridT],
    cells: ArrayLike,
    *,
    resolution: float,
    origin: object = None,
    header: object = None,
) -> GridT:
    """Make a grid of this class (nav_msgs.msg.OccupancyGrid) from cells, in the order of `grid_array`.

    `resolution` is the edge length of a cell [m]. `origin` is a geometry_msgs/msg/Pose: the outer corner of
    cell (0, 0) and the direction of the map's axes, in the frame of the header. It is the identity if it is
    not given. The cells are copied. They may have any integer type.

    Raise ConversionError if they are not integers of shape (height, width) in [-128, 127].
    """
    values = np.asarray(cells)
    path = f"{cls.__name__}.data"
    if values.ndim != 2 or values.dtype.kind not in "iu":
        raise ConversionError(path, f"expected integers of shape (height, width), got {described(values)}")
    if values.dtype != _INT8 and (outside := np.flatnonzero((values < -128) | (values > 127))).size:
        index = int(outside[0])
        row, column = divmod(index, values.shape[1])
        raise ConversionError(
            f"{path}[{index}]",
            f"expected an integer in [-128, 127], got {values[row, column]} in row {row}, column {column}",
        )
    if not (math.isfinite(resolution) and resolution > 0):
        raise ConversionError(f"{cls.__name__}.info.resolution", f"expected more than 0 m, got {resolution}")
    message: GridT = new_message(cls, _GRID, header, {"data": copied(cls, "data", values, _INT8, "b")})
    info: Any = message.info
    require(info, "nav_msgs/msg/MapMetaData", "height", "width", "resolution", "origin")
    info.height = checked_size(cls, "info.height", values.shape[0])
    info.width = checked_size(cls, "info.width", values.shape[1])
    info.resolution = float(resolution)
    if origin is not None:
        info.origin = origin
    return message

"""Messages of nav_msgs.

Classes are loaded when they are first used.
"""

from __future__ import annotations

from ifgen_runtime.lazy import lazy_exports

TYPE_CHECKING = False  # typing itself takes longer to import than this package
if TYPE_CHECKING:
    from nav_msgs.msg._goals import Goals as Goals
    from nav_msgs.msg._grid_cells import GridCells as GridCells
    from nav_msgs.msg._map_meta_data import MapMetaData as MapMetaData
    from nav_msgs.msg._occupancy_grid import OccupancyGrid as OccupancyGrid
    from nav_msgs.msg._odometry import Odometry as Odometry
    from nav_msgs.msg._path import Path as Path

__all__ = [
    "Goals",
    "GridCells",
    "MapMetaData",
    "OccupancyGrid",
    "Odometry",
    "Path",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Goals": "_goals",
        "GridCells": "_grid_cells",
        "MapMetaData": "_map_meta_data",
        "OccupancyGrid": "_occupancy_grid",
        "Odometry": "_odometry",
        "Path": "_path",
    },
)

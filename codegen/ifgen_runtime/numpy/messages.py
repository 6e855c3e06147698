"""The messages that this package works on, by their fields. A type checker accepts every class that has them.

The fields are those of common_interfaces (Jazzy). What holds other messages or arrays is a read-only
property here, so that each class may have a type of its own for it.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

Integers: TypeAlias = "array[int] | NDArray[np.integer[Any]]"
Floats: TypeAlias = "array[float] | NDArray[np.floating[Any]]"


class ImageMessage(Protocol):
    """`sensor_msgs/msg/Image`."""

    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int

    @property
    def data(self) -> Integers:
        """`uint8[]`."""
        ...


class PointFieldMessage(Protocol):
    """`sensor_msgs/msg/PointField`."""

    name: str
    offset: int
    datatype: int
    count: int


class PointCloudMessage(Protocol):
    """`sensor_msgs/msg/PointCloud2`."""

    height: int
    width: int
    is_bigendian: bool
    point_step: int
    row_step: int
    is_dense: bool

    @property
    def fields(self) -> Sequence[PointFieldMessage]:
        """`PointField[]`."""
        ...

    @property
    def data(self) -> Integers:
        """`uint8[]`."""
        ...


class ScanMessage(Protocol):
    """`sensor_msgs/msg/LaserScan`."""

    angle_min: float
    angle_max: float
    angle_increment: float
    range_min: float
    range_max: float

    @property
    def ranges(self) -> Floats:
        """`float32[]`."""
        ...

    @property
    def intensities(self) -> Floats:
        """`float32[]`."""
        ...


class MapInfoMessage(Protocol):
    """`nav_msgs/msg/MapMetaData`."""

    resolution: float
    width: int
    height: int


class GridMessage(Protocol):
    """`nav_msgs/msg/OccupancyGrid`."""

    @property
    def info(self) -> MapInfoMessage:
        """`MapMetaData`."""
        ...

    @property
    def data(self) -> Integers:
        """`int8[]`."""
        ...


class VectorMessage(Protocol):
    """`geometry_msgs/msg/Vector3` or `geometry_msgs/msg/Point`."""

    x: float
    y: float
    z: float


class QuaternionMessage(Protocol):
    """`geometry_msgs/msg/Quaternion`."""

    x: float
    y: float
    z: float
    w: float


class TransformMessage(Protocol):
    """`geometry_msgs/msg/Transform`."""

    @property
    def translation(self) -> VectorMessage:
        """`Vector3`."""
        ...

    @property
    def rotation(self) -> QuaternionMessage:
        """`Quaternion`."""
        ...


class PoseMessage(Protocol):
    """`geometry_msgs/msg/Pose`."""

    @property
    def position(self) -> VectorMessage:
        """`Point`."""
        ...

    @property
    def orientation(self) -> QuaternionMessage:
        """`Quaternion`."""
        ...


class HoldsTransform(Protocol):
    """`geometry_msgs/msg/TransformStamped`."""

    @property
    def transform(self) -> TransformMessage:
        """`Transform`."""
        ...


class HoldsPose(Protocol):
    """`geometry_msgs/msg/PoseStamped`, or `PoseWithCovariance`."""

    @property
    def pose(self) -> PoseMessage:
        """`Pose`."""
        ...

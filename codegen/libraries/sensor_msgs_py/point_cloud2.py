"""Points of `sensor_msgs/msg/PointCloud2` as numpy arrays, and clouds of points."""

import array
import sys
from collections import namedtuple
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, TypeAlias, cast

from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

from sensor_msgs_py._layout import DUMMY_FIELD_PREFIX, dtype_from_fields, points_of
from sensor_msgs_py._numpy import numpy as np
from sensor_msgs_py._numpy import structured_to_unstructured

__all__ = [
    "DUMMY_FIELD_PREFIX",
    "create_cloud",
    "create_cloud_xyz32",
    "dtype_from_fields",
    "read_points",
    "read_points_list",
    "read_points_numpy",
]

_Array: TypeAlias = np.ndarray[Any, np.dtype[Any]]


def read_points(
    cloud: PointCloud2,
    field_names: Iterable[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> _Array:
    """Return points as a structured array, with all fields or with those named.

    It is a view of the cloud's data where that is in the byte order of this machine, and a copy otherwise.
    `skip_nans` leaves out points with a NaN, unless the cloud is dense. `uvs` are the indices of the points
    to return, of those that are left. `reshape_organized_cloud` returns a cloud of several rows as an array
    of (width, height). Raises AssertionError for a name that is no field, and ValueError for a cloud that
    contradicts itself, such as one with too little data.
    """
    assert isinstance(cloud, PointCloud2), "Cloud is not a sensor_msgs.msg.PointCloud2"
    points = points_of(cloud)
    if field_names is not None:
        names = list(field_names)
        known = points.dtype.names or ()
        assert all(name in known for name in names), "Requests field is not in the fields of the PointCloud!"
        points = points[names]
    if not points.dtype.isnative:
        swapped = np.zeros(points.shape, points.dtype.newbyteorder("="))  # 0 between values
        swapped[...] = points
        points = swapped
    if skip_nans and not cloud.is_dense:
        kept = np.ones(len(points), dtype=bool)
        for name in points.dtype.names or ():
            kept &= ~np.isnan(points[name])
        points = points[kept]
    if uvs is not None:
        points = points[uvs if isinstance(uvs, np.ndarray) else np.fromiter(uvs, int)]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.width, cloud.height)
    return points


def read_points_numpy(
    cloud: PointCloud2,
    field_names: Iterable[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> _Array:
    """Return points as a plain array with a column for each field. All of these must have one datatype.

    See `read_points`. Raises AssertionError for fields of several datatypes.
    """
    points = read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
    kinds = {points.dtype[name] for name in points.dtype.names or ()}
    assert len(kinds) <= 1, "All fields need to have the same datatype. Use `read_points()` otherwise."
    return structured_to_unstructured(points)


def read_points_list(
    cloud: PointCloud2,
    field_names: Iterable[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
) -> list[Any]:
    """Return points as a list of named tuples `Point`. See `read_points`, which is faster."""
    points = read_points(cloud, field_names, skip_nans, uvs)
    Point = namedtuple("Point", points.dtype.names or ())  # type: ignore[misc]  # names are known at run time
    return [Point._make(point) for point in points]


def create_cloud(
    header: Header, fields: Iterable[PointField], points: Iterable[Any], point_step: int | None = None
) -> PointCloud2:
    """Return a cloud with these fields, in the byte order of this machine.

    `points` is a structured array with these fields; or a plain array whose last axis are the fields, which
    then must have one datatype; or an iterable of points, each with its values in the order of the fields. An
    array with one more axis becomes a cloud of (width, height) points. `point_step` is the size of a point in
    bytes; without it that of the structured array, or else up to the last value.

    Raises AssertionError for points that do not fit the fields, and what `dtype_from_fields` raises.
    """
    fields = list(fields)
    if isinstance(points, np.ndarray):
        given = cast(_Array, points)
        source = (_of_columns if given.dtype.names is None else _structured)(given, fields, point_step)
    else:
        source = _of_rows(points, dtype_from_fields(fields, point_step))
    assert len(source.shape) <= 2, (
        "Too many dimensions for organized cloud! Points can only be organized in max. two dimensional space"
    )
    width, height = source.shape if len(source.shape) == 2 else (*source.shape, 1)
    step = source.dtype.itemsize
    cloud = PointCloud2(
        header=header,
        height=height,
        width=width,
        is_dense=False,
        is_bigendian=sys.byteorder != "little",
        fields=fields,
        point_step=step,
        row_step=step * width,
    )
    # An array of bytes, which a message takes as it is; it would look at each value of a list.
    data = array.array("B", [0]) * (step * width * height)
    values: _Array = np.ndarray(source.shape, source.dtype, buffer=data)
    for name, column in source.columns.items():
        values[name] = column
    cloud.data = data
    return cloud


def create_cloud_xyz32(header: Header, points: Iterable[Any]) -> PointCloud2:
    """Return a cloud of points with x, y and z as float32. See `create_cloud`."""
    fields = [
        PointField(name=name, offset=offset, datatype=PointField.FLOAT32, count=1)
        for name, offset in (("x", 0), ("y", 4), ("z", 8))
    ]
    return create_cloud(header, fields, points)


class _Source(NamedTuple):
    """Points to be written: how a cloud has them, how many there are along each axis, and their values."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    columns: Mapping[str, Any]


def _structured(points: _Array, fields: list[PointField], point_step: int | None) -> _Source:
    """The points of a structured array that has these fields."""
    dtype = dtype_from_fields(fields, points.dtype.itemsize if point_step is None else point_step)
    assert points.dtype == dtype, (
        "PointFields and structured NumPy array dtype do not match for all fields! "
        "Check their field order, names and types."
    )
    return _Source(dtype, points.shape, {name: points[name] for name in dtype.names or ()})


def _of_columns(points: _Array, fields: list[PointField], point_step: int | None) -> _Source:
    """The points of a plain array with a column for each value."""
    assert len({field.datatype for field in fields}) <= 1, (
        "All fields need to have the same datatype. "
        "Pass a structured NumPy array with multiple dtypes otherwise."
    )
    dtype = dtype_from_fields(fields, point_step)
    names = dtype.names or ()
    if not points.ndim or points.shape[-1] != len(names):
        raise ValueError(
            f"points have shape {points.shape}, but the last axis should have {len(names)} values"
        )
    columns = {name: points[..., index] for index, name in enumerate(names)}
    return _Source(dtype, points.shape[:-1], columns)


def _of_rows(points: Iterable[Any], dtype: np.dtype[Any]) -> _Source:
    """Points that Python has as sequences."""
    names = dtype.names or ()
    rows = np.array([tuple(point) for point in points], dtype=[(name, dtype[name]) for name in names])
    return _Source(dtype, rows.shape, {name: rows[name] for name in names})

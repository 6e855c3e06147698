"""sensor_msgs/msg/PointCloud2, its fields, and structured numpy arrays, with one record for each point."""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from numpy.lib.stride_tricks import as_strided
from numpy.typing import ArrayLike, NDArray

from ifgen_runtime.codec.encoding import shown
from ifgen_runtime.errors import ConversionError
from ifgen_runtime.field_types import fields_of
from ifgen_runtime.numpy.fields import (
    checked_size,
    copied,
    described,
    name_of,
    new_message,
    octets_in,
    require,
    size_in,
)
from ifgen_runtime.numpy.messages import PointCloudMessage

_DATATYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""The constants of sensor_msgs/msg/PointField."""
_CODES = {dtype: code for code, dtype in _DATATYPES.items()}
_PADDING = ("", "_")
_MAXIMUM_STEP = 2**31 - 1  # numpy's limit for the size of an item


def point_dtype(cloud: PointCloudMessage) -> np.dtype[Any]:
    """The dtype of a cloud's points: names, offsets, byte order; `count` > 1 is a subarray.

    A `count` of 0 means 1, as in PCL. Fields named "_" or "", which PCL uses for padding, are left out.
    """
    point_step = size_in(cloud, "point_step", maximum=_MAXIMUM_STEP)
    order = ">" if cloud.is_bigendian else "<"
    names: list[str] = []
    formats: list[Any] = []
    offsets: list[int] = []
    taken: set[str] = set()
    for index, field in enumerate(cloud.fields):
        path = f"{name_of(cloud)}.fields[{index}]"
        require(field, f"sensor_msgs/msg/PointField in {path}", "name", "offset", "datatype", "count")
        name: Any = field.name
        offset = size_in(field, "offset", path)
        code, count = size_in(field, "datatype", path, 255), size_in(field, "count", path) or 1
        if name in _PADDING:
            continue
        if not isinstance(name, str) or name in taken:
            raise ConversionError(f"{path}.name", f"expected a name of its own, got {shown(name)}")
        if code not in _DATATYPES:
            raise ConversionError(f"{path}.datatype", f"expected 1 (INT8) to 8 (FLOAT64), got {code}")
        dtype = np.dtype(order + _DATATYPES[code])
        end = offset + dtype.itemsize * count
        if end > point_step:
            raise ConversionError(
                f"{path}.offset", f"{shown(name)} ends at byte {end}, beyond point_step {point_step}"
            )
        taken.add(name)
        names.append(name)
        formats.append(dtype if count == 1 else (dtype, (count,)))
        offsets.append(offset)
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": point_step})


def fields_of_dtype(cls: type[Any], dtype: np.dtype[Any]) -> list[Any]:
    """The fields that describe a structured dtype, of the class that this class of clouds has for them."""
    field_class: Any = next((field.type for field in fields_of(cls) if field.name == "fields"), None)
    return [
        new_message(field_class, "sensor_msgs/msg/PointField", None, _field_values(cls, index, name, dtype))
        for index, name in enumerate(dtype.names or ())
    ]


def _field_values(cls: type[Any], index: int, name: str, dtype: np.dtype[Any]) -> dict[str, Any]:
    described: Any = dtype.fields
    inner, offset = described[name][:2]
    item = inner.base
    code = _CODES.get(item.str[1:]) if item.names is None else None
    if code is None:
        raise ConversionError(
            f"{cls.__name__}.fields[{index}].datatype",
            f"'{name}' is {item}; a point can hold 8 to 32 bit integers, float32 and float64",
        )
    return {"name": name, "offset": offset, "datatype": code, "count": math.prod(inner.shape)}


CloudT = TypeVar("CloudT", bound=PointCloudMessage)

_CLOUD = "sensor_msgs/msg/PointCloud2"
_FIELDS = ("height", "width", "fields", "is_bigendian", "point_step", "row_step", "data")


def point_array(cloud: PointCloudMessage) -> NDArray[np.void]:
    """View the points of a sensor_msgs/msg/PointCloud2 without a copy.

    The shape is (width,), or (height, width) if the cloud is organised, which means that its height is
    above 1. The names of the dtype are those of `cloud.fields`, so `points["x"]` has the x of each point
    [m], in the frame of the header. A field with a `count` of more than 1 has one more dimension. Fields
    named "_" or "", which PCL uses for padding, are left out. The dtype has the byte order that
    `is_bigendian` states.

    Writing to the view writes to the cloud. Raise ConversionError if a field does not fit into
    `point_step`, or if `row_step` or `data` is too small for the size.
    """
    require(cloud, _CLOUD, *_FIELDS)
    height, width = size_in(cloud, "height"), size_in(cloud, "width")
    dtype = point_dtype(cloud)
    shape = (height, width) if height > 1 else (height * width,)
    if height * width == 0:
        return np.empty(shape, dtype)
    if dtype.itemsize == 0:
        raise ConversionError(f"{name_of(cloud)}.point_step", "expected at least 1, got 0")
    row_size = width * dtype.itemsize
    # Many drivers leave row_step at 0 in clouds of one row.
    row_step = size_in(cloud, "row_step") if height > 1 else row_size
    if row_step < row_size:
        raise ConversionError(
            f"{name_of(cloud)}.row_step",
            f"expected at least {row_size} for {width} points of {dtype.itemsize} bytes, got {row_step}",
        )
    data, end = octets_in(cloud, "data"), (height - 1) * row_step + row_size
    if len(data) < end:
        raise ConversionError(f"{name_of(cloud)}.data", f"expected at least {end} bytes, got {len(data)}")
    return np.ndarray(shape, dtype, data, 0, (row_step, dtype.itemsize)[-len(shape) :])


def xyz_array(cloud: PointCloudMessage) -> NDArray[np.floating[Any]]:
    """View the coordinates of a cloud's points without a copy: shape (..., 3), float32 or float64 [m].

    The shape before that is that of `point_array`. Points without a measurement have NaN coordinates.

    Raise ConversionError as `point_array` does, and if the cloud has no x, y and z of one float type at equal
    distances, which no view could cover.
    """
    points = point_array(cloud)
    fields: Any = points.dtype.fields or {}
    try:
        (kind, x), (other, y), (another, z) = (fields[name][:2] for name in "xyz")
    except KeyError:
        found = shown(list(points.dtype.names or ()))
        raise ConversionError(f"{name_of(cloud)}.fields", f"expected x, y and z, got {found}") from None
    if not kind == other == another or kind.kind != "f" or y - x != z - y or abs(y - x) < kind.itemsize:
        raise ConversionError(
            f"{name_of(cloud)}.fields",
            "x, y and z need one float type and equal distances: stack the fields of point_array instead",
        )
    return as_strided(points["x"], (*points.shape, 3), (*points.strides, y - x))


def from_point_array(
    cls: type[CloudT], points: ArrayLike, *, header: object = None, is_dense: bool | None = None
) -> CloudT:
    """Make a cloud of this class (sensor_msgs.msg.PointCloud2) from points, which are copied once.

    `points` is a structured array of shape (width,), or (height, width) for an organised cloud, whose items
    are integers of 8 to 32 bits, float32, float64, or subarrays of them. Offsets are kept, so padding is,
    too. A plain float32 or float64 array of shape (width, 3) or (height, width, 3) holds x, y and z [m].

    The cloud is little endian. Without `header` it has a default one. Without `is_dense`, x, y and z are
    searched for values that are not finite. Raise ConversionError if a PointField cannot describe the
    dtype.
    """
    records = _records(cls, np.asarray(points))
    dtype = records.dtype.newbyteorder("<")
    values = {
        "height": checked_size(cls, "height", records.shape[0] if records.ndim == 2 else 1),
        "width": checked_size(cls, "width", records.shape[-1]),
        "fields": fields_of_dtype(cls, dtype),
        "is_bigendian": False,
        "point_step": dtype.itemsize,
        "row_step": checked_size(cls, "row_step", records.shape[-1] * dtype.itemsize),
        "data": copied(cls, "data", records, dtype),
        "is_dense": _is_dense(records) if is_dense is None else is_dense,
    }
    message: CloudT = new_message(cls, _CLOUD, header, values)
    return message


def _records(cls: type[Any], points: NDArray[Any]) -> NDArray[Any]:
    """The same points as a structured array of one or two dimensions."""
    if points.dtype.names is None and points.dtype.char in "fd" and points.shape[-1:] == (3,):
        dtype = np.dtype([(name, points.dtype) for name in "xyz"])
        points = np.ascontiguousarray(points).view(dtype)[..., 0]
    if not points.dtype.names or points.ndim not in (1, 2):
        raise ConversionError(
            f"{cls.__name__}.data",
            "expected a structured array of shape (width,) or (height, width), or float32 or float64 "
            f"of shape (width, 3) or (height, width, 3), got {described(points)}",
        )
    return points


def _is_dense(points: NDArray[Any]) -> bool:
    fields: Any = points.dtype.fields or {}
    floats = [name for name in "xyz" if name in fields and fields[name][0].base.kind == "f"]
    return all(bool(np.isfinite(points[name]).all()) for name in floats)

"""Where the values of a point are, and where the points of a cloud: all of it checked before it is used."""

from collections.abc import Iterable
from typing import Any

from sensor_msgs.msg import PointCloud2, PointField

from sensor_msgs_py._numpy import numpy as np

DUMMY_FIELD_PREFIX = "unnamed_field"

_DATATYPES: dict[int, np.dtype[Any]] = {
    PointField.INT8: np.dtype(np.int8),
    PointField.UINT8: np.dtype(np.uint8),
    PointField.INT16: np.dtype(np.int16),
    PointField.UINT16: np.dtype(np.uint16),
    PointField.INT32: np.dtype(np.int32),
    PointField.UINT32: np.dtype(np.uint32),
    PointField.FLOAT32: np.dtype(np.float32),
    PointField.FLOAT64: np.dtype(np.float64),
}
# A field of a message can claim to have four thousand million values, which would take as many names.
_MOST_VALUES = 65536
_LARGEST_POINT = 2**31 - 1  # [B] what numpy can have as one value


def dtype_from_fields(fields: Iterable[PointField], point_step: int | None = None) -> np.dtype[Any]:
    """Return the structured dtype of points with these fields, in the byte order of this machine.

    A field without a name is `unnamed_field_N`, by its place. One with several values becomes as many
    columns: `NAME_0`, `NAME_1` and so on. `point_step` is the size of a point in bytes; without it a point
    ends with its last value. Raises AssertionError for a field with no values and for two of one name, and
    ValueError for fields that cannot be.
    """
    size = _LARGEST_POINT if point_step is None else point_step
    if size > _LARGEST_POINT:
        raise ValueError(f"a point of {size} bytes is larger than numpy can have ({_LARGEST_POINT} bytes)")
    names: list[str] = []
    formats: list[str] = []
    offsets: list[int] = []
    for index, field in enumerate(fields):
        name = field.name or f"{DUMMY_FIELD_PREFIX}_{index}"
        datatype = _DATATYPES.get(field.datatype)
        if datatype is None:
            raise ValueError(f"field '{name}' has datatype {field.datatype}, which is none of PointField's")
        assert field.count > 0, "Can't process fields with count = 0."
        end = field.offset + field.count * datatype.itemsize
        if end > size:
            raise ValueError(f"field '{name}' ends at byte {end} of a point, which can have {size}")
        if len(names) + field.count > _MOST_VALUES:
            raise ValueError(f"a point has more than {_MOST_VALUES} values with field '{name}'")
        names += [name] if field.count == 1 else [f"{name}_{number}" for number in range(field.count)]
        formats += [datatype.str] * field.count
        offsets += range(field.offset, end, datatype.itemsize)
    assert len(names) == len(set(names)), "Duplicate field names are not allowed!"
    layout: Any = {"names": names, "formats": formats, "offsets": offsets}
    if point_step is not None:
        layout["itemsize"] = point_step
    dtype: np.dtype[Any] = np.dtype(layout)
    return dtype


def points_of(cloud: PointCloud2) -> np.ndarray[Any, np.dtype[Any]]:
    """Return the points of a cloud as a view of its data, in its byte order: one dimension, row by row.

    Rows may have bytes after their last point. Raises ValueError for a cloud that contradicts itself.
    """
    dtype = dtype_from_fields(cloud.fields, cloud.point_step)
    dtype = dtype.newbyteorder(">" if cloud.is_bigendian else "<")
    row = cloud.width * cloud.point_step
    # With one row its size means nothing, and many programs leave it out.
    row_step = cloud.row_step if cloud.height > 1 and cloud.row_step else row
    size = f"{cloud.width} x {cloud.height} points of {cloud.point_step} bytes"
    if cloud.width * cloud.height and not cloud.point_step:
        raise ValueError(f"a cloud of {size} has no data to read")
    if row_step < row:
        raise ValueError(f"a cloud of {size} has rows of {row} bytes, but its row_step is {row_step}")
    needed = row_step * (cloud.height - 1) + row if cloud.height else 0
    if needed > len(cloud.data):
        raise ValueError(f"a cloud of {size} needs {needed} bytes of data, but has {len(cloud.data)}")
    if not needed:
        return np.empty(0, dtype)
    strides = (row_step, cloud.point_step)
    points = np.ndarray((cloud.height, cloud.width), dtype, buffer=cloud.data, strides=strides)
    return points.reshape(-1)

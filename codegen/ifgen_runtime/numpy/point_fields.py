"""The fields of a sensor_msgs/msg/PointCloud2 as the dtype of a structured numpy array, and back."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ifgen_runtime.codec.encoding import shown
from ifgen_runtime.errors import ConversionError
from ifgen_runtime.field_types import fields_of
from ifgen_runtime.numpy.fields import name_of, new_message, require, size_in
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

"""sensor_msgs/msg/LaserScan and numpy: the angles of its rays [rad], and the points that they hit [m]."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ifgen_runtime.errors import ConversionError
from ifgen_runtime.numpy.fields import copied, described, items_in, new_message, number_in, require
from ifgen_runtime.numpy.messages import ScanMessage

ScanT = TypeVar("ScanT", bound=ScanMessage)

_SCAN = "sensor_msgs/msg/LaserScan"
_FIELDS = ("angle_min", "angle_increment", "range_min", "range_max", "ranges")
_FLOAT32 = np.dtype(np.float32)


def scan_angles(scan: ScanMessage) -> NDArray[np.float64]:
    """The angle of each ray of a sensor_msgs/msg/LaserScan, of shape (n,) [rad].

    Angles are counter-clockwise from the x axis of the scanner's frame. Ray i has the angle angle_min + i *
    angle_increment; `angle_max` is not used. `as_array(scan.ranges)` has the ranges that go with them.
    """
    require(scan, _SCAN, *_FIELDS)
    first, increment = _number_in(scan, "angle_min"), _number_in(scan, "angle_increment")
    return first + increment * np.arange(len(items_in(scan, "ranges", _FLOAT32)), dtype=np.float64)


def scan_points(scan: ScanMessage) -> NDArray[np.float64]:
    """The point that each ray hit, of shape (n, 2): x and y in the scanner's frame [m].

    A ray has NaN if its range is not from `range_min` to `range_max`, or not a finite number (REP-117), so
    that row i always belongs to ray i. `points[numpy.isfinite(points[:, 0])]` has the hits only.
    """
    angles = scan_angles(scan)
    ranges = items_in(scan, "ranges", _FLOAT32)
    # numpy rounds the limits to float32 before it compares: a range of 0.1 is not below a range_min of 0.1.
    low, high = _number_in(scan, "range_min"), _number_in(scan, "range_max")
    valid = np.isfinite(ranges) & (low <= ranges) & (ranges <= high)
    distances = np.where(valid, ranges, np.nan).astype(np.float64)
    return np.stack((distances * np.cos(angles), distances * np.sin(angles)), axis=-1)


def from_ranges(  # each is a property of the device
    cls: type[ScanT],
    ranges: ArrayLike,
    *,
    angles: tuple[float, float],
    limits: tuple[float, float],
    intensities: ArrayLike | None = None,
    header: object = None,
) -> ScanT:
    """Make a scan of this class (sensor_msgs.msg.LaserScan) from the ranges of its rays, of shape (n,) [m].

    `angles` are those of the first and of the last ray [rad]; the others are spread evenly between them.
    `limits` are the smallest and the largest range that is valid [m]. `intensities` has one number for each
    ray, if given. Ranges may be infinite or NaN (REP-117). The times between rays and scans stay 0.

    Raise ConversionError if an array is not one row of numbers that fit into float32, or has another length.
    """
    distances = _float32(cls, "ranges", ranges)
    strengths = _float32(cls, "intensities", [] if intensities is None else intensities)
    if intensities is not None and strengths.size != distances.size:
        raise ConversionError(
            f"{cls.__name__}.intensities", f"expected {distances.size} as for ranges, got {strengths.size}"
        )
    values = {
        "angle_min": float(angles[0]),
        "angle_max": float(angles[1]),
        "angle_increment": float(angles[1] - angles[0]) / max(distances.size - 1, 1),
        "range_min": float(limits[0]),
        "range_max": float(limits[1]),
        "ranges": copied(cls, "ranges", distances, _FLOAT32, "f"),
        "intensities": copied(cls, "intensities", strengths, _FLOAT32, "f"),
    }
    message: ScanT = new_message(cls, _SCAN, header, values)
    return message


def _number_in(scan: ScanMessage, name: str) -> float:
    return number_in(scan, name, limit=float(np.finfo(np.float32).max))


def _float32(cls: type[Any], name: str, values: ArrayLike) -> NDArray[np.float32]:
    array = np.asarray(values)
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iuf"):
        raise ConversionError(
            f"{cls.__name__}.{name}", f"expected numbers of shape (n,), got {described(array)}"
        )
    with np.errstate(over="ignore"):
        converted = array.astype(np.float32)
    beyond = np.flatnonzero(np.isinf(converted) & np.isfinite(array.astype(np.float64)))
    if beyond.size:
        index = int(beyond[0])
        raise ConversionError(
            f"{cls.__name__}.{name}[{index}]", f"{array[index].item()!r} does not fit into a float32"
        )
    return converted

"""Poses and transforms of geometry_msgs, and homogeneous 4 x 4 matrices.

Quaternions are x, y, z, w, as everywhere in ROS (REP 103, tf2).
"""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ifgen_runtime.codec.encoding import kind_of
from ifgen_runtime.errors import ConversionError
from ifgen_runtime.numpy.fields import described, name_of, number_in, require
from ifgen_runtime.numpy.messages import HoldsPose, HoldsTransform, PoseMessage, TransformMessage

MessageT = TypeVar("MessageT", bound=TransformMessage | PoseMessage | HoldsTransform | HoldsPose)

TOLERANCE = 0.01
"""How far the squared length of a quaternion may be from 1, as in tf2; the same for the axes of a matrix."""

_LIKE = "geometry_msgs/msg/Pose, Transform, PoseStamped or TransformStamped"


def transform_matrix(
    message: TransformMessage | PoseMessage | HoldsTransform | HoldsPose,
) -> NDArray[np.float64]:
    """The 4 x 4 matrix of a Transform, Pose, TransformStamped, PoseStamped or PoseWithCovariance.

    The matrix of a pose takes coordinates in the body's frame to coordinates in the frame of the header;
    that of a transform takes them from the child frame to the frame of the header. So `a @ b` is the
    transform from the child of b to the parent of a. Rotation is above left, translation [m] in the last
    column.

    The quaternion is normalised. Raise ConversionError if its squared length is not 1 within 0.01 (tf2's
    tolerance), or if a number is not finite.
    """
    place, rotation, path, names = _parts(message, name_of(message))
    x, y, z, w = (number_in(rotation, name, f"{path}.{names[1]}") for name in "xyzw")
    square = x * x + y * y + z * z + w * w
    if not abs(square - 1.0) <= TOLERANCE:
        raise ConversionError(
            f"{path}.{names[1]}",
            f"expected a unit quaternion, got length {math.sqrt(square):.6g}; divide it by its length",
        )
    s = 2.0 / square
    matrix = np.identity(4)
    matrix[:3] = (
        (1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), 0.0),
        (s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), 0.0),
        (s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), 0.0),
    )
    matrix[:3, 3] = [number_in(place, name, f"{path}.{names[0]}") for name in "xyz"]
    return matrix


def from_transform_matrix(
    cls: type[MessageT], matrix: ArrayLike, *, header: object = None, child_frame_id: str | None = None
) -> MessageT:
    """Make a pose or a transform of this class, which is one that `transform_matrix` takes, from a matrix.

    `matrix` is a homogeneous 4 x 4 matrix as `transform_matrix` returns it. Of the two quaternions for its
    rotation, the message has the one with w >= 0. `header` and `child_frame_id` are for classes with these
    fields.

    Raise ConversionError if the matrix is not a rotation and a translation: its axes must have unit length
    and be perpendicular, within 0.01, and right-handed.
    """
    message: Any = cls()
    place, rotation, path, names = _parts(message, cls.__name__)
    values = np.asarray(matrix, dtype=np.float64)
    if values.shape != (4, 4) or not np.isfinite(values).all():
        raise ConversionError(path, f"expected a finite matrix of shape (4, 4), got {described(values)}")
    if np.abs(values[3] - (0, 0, 0, 1)).max() > 1e-9:
        raise ConversionError(
            path, f"expected 0, 0, 0, 1 in the last row of the matrix, got {values[3].tolist()}"
        )
    axes = values[:3, :3]
    if np.abs(axes.T @ axes - np.identity(3)).max() > TOLERANCE or np.linalg.det(axes) < 0:
        raise ConversionError(
            f"{path}.{names[1]}",
            "the upper left of the matrix is no rotation: its axes must be perpendicular, of length 1, "
            "and right-handed",
        )
    for part, keys, numbers in ((place, "xyz", values[:3, 3]), (rotation, "xyzw", _quaternion(axes))):
        for key, number in zip(keys, numbers.tolist(), strict=True):
            setattr(part, key, number)
    for name, value in (("header", header), ("child_frame_id", child_frame_id)):
        if value is not None:
            require(message, _LIKE, name)
            setattr(message, name, value)
    made: MessageT = message
    return made


def _parts(message: Any, path: str) -> tuple[Any, Any, str, tuple[str, str]]:
    """The parts for the place and the rotation, the path of the message that has them, and their names."""
    for names in (("translation", "rotation"), ("position", "orientation")):
        if hasattr(message, names[0]) and hasattr(message, names[1]):
            return getattr(message, names[0]), getattr(message, names[1]), path, names
    for name in ("transform", "pose"):
        if hasattr(message, name):
            return _parts(getattr(message, name), f"{path}.{name}")
    raise TypeError(f"expected {_LIKE}, got {kind_of(message)}")


def _quaternion(axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit quaternion (x, y, z, w) of a rotation matrix, with w >= 0."""
    (a, b, c), (d, e, f), (g, h, i) = axes.tolist()
    # Four times the products of the quaternion's numbers with each other. The row with the largest square
    # is the quaternion times a number that is not small.
    products = np.array(
        (
            (1 + a - e - i, b + d, c + g, h - f),
            (b + d, 1 - a + e - i, f + h, c - g),
            (c + g, f + h, 1 - a - e + i, d - b),
            (h - f, c - g, d - b, 1 + a + e + i),
        )
    )
    row: NDArray[np.float64] = products[int(products.diagonal().argmax())]
    return row / math.copysign(float(np.linalg.norm(row)), row[3])

# Arrays are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Transforms of point clouds, registered with `tf2_ros`."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from geometry_msgs.msg import Transform, TransformStamped
from sensor_msgs.msg import PointCloud2
from sensor_msgs_py.point_cloud2 import create_cloud, read_points
from tf2_ros.buffer_interface import ConvertRegistration, TransformRegistration

__all__ = ["do_transform_cloud", "from_msg_msg", "to_msg_msg", "transform_points"]

Message = TypeVar("Message")


def to_msg_msg(msg: Message) -> Message:
    """Return a message as a message: itself."""
    return msg


def from_msg_msg(msg: Message) -> Message:
    """Return what a message stands for: itself."""
    return msg


def transform_points(point_cloud: Any, transform: Transform | TransformStamped) -> Any:
    """Return points, an array of (n, 3), in the frame of a transform."""
    inner = transform.transform if isinstance(transform, TransformStamped) else transform
    at, q = inner.translation, inner.rotation
    return np.asarray(point_cloud) @ _matrix(q.x, q.y, q.z, q.w).T + np.array([at.x, at.y, at.z])


def do_transform_cloud(cloud: PointCloud2, transform: TransformStamped) -> PointCloud2:
    """Return a cloud with its fields x, y and z in the frame of a transform, and the others as before."""
    points = read_points(cloud).copy()
    whole = np.stack([points[name].astype(np.float64) for name in "xyz"], axis=-1)
    moved = transform_points(whole, transform)
    for number, name in enumerate("xyz"):
        points[name] = moved[:, number]
    result = create_cloud(transform.header, cloud.fields, points)
    result.height, result.width = cloud.height, cloud.width
    result.row_step = result.point_step * cloud.width
    result.is_dense = cloud.is_dense
    return result


def _matrix(x: float, y: float, z: float, w: float) -> Any:
    """Return a rotation matrix; a quaternion of length 0 does not rotate."""
    square = x * x + y * y + z * z + w * w
    if square < np.finfo(np.float64).eps:
        return np.eye(3)
    s = 2.0 / square
    return np.array(
        [
            [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
        ]
    )


ConvertRegistration().add_to_msg(PointCloud2, to_msg_msg)
ConvertRegistration().add_from_msg(PointCloud2, from_msg_msg)
TransformRegistration().add(PointCloud2, do_transform_cloud)

"""A function for each type of message, registered with `tf2_ros`.

A `TransformStamped` takes coordinates in its `child_frame_id` to coordinates in its `header.frame_id`.
Results get its header. Rotations need not have length 1; one of length 0 does not rotate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol, TypeAlias, TypeVar

from geometry_msgs.msg import (
    Point,
    Point32,
    PointStamped,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TransformStamped,
    Vector3,
    Vector3Stamped,
)
from tf2_ros.buffer_interface import ConvertRegistration, TransformRegistration

Message = TypeVar("Message")
Vector: TypeAlias = tuple[float, float, float]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]  # rows


class _Coordinates(Protocol):
    x: float
    y: float
    z: float


def to_msg_msg(msg: Message) -> Message:
    """Return a message as a message: itself."""
    return msg


def from_msg_msg(msg: Message) -> Message:
    """Return what a message stands for: itself."""
    return msg


def transform_covariance(cov_in: Sequence[float] | Any, transform: TransformStamped) -> Any:
    """Return a covariance of position and rotation in the transform's frame.

    :param cov_in: 36 numbers, row by row.
    :returns: an array as in `PoseWithCovariance`.
    """
    turn = _matrix(transform.transform.rotation)
    rows = [_turned(turn, cov_in[start : start + 6]) for start in range(0, 36, 6)]
    columns = [_turned(turn, column) for column in zip(*rows, strict=True)]
    result = PoseWithCovarianceStamped()
    result.pose.covariance = [value for row in zip(*columns, strict=True) for value in row]
    return result.pose.covariance


def do_transform_point(point: PointStamped, transform: TransformStamped) -> PointStamped:
    """Return a point in the transform's frame."""
    x, y, z = _moved(point.point, transform)
    return PointStamped(header=transform.header, point=Point(x=x, y=y, z=z))


def do_transform_vector3(vector3: Vector3Stamped, transform: TransformStamped) -> Vector3Stamped:
    """Return a vector in the transform's frame: rotated, not translated."""
    x, y, z = _product(_matrix(transform.transform.rotation), _vector(vector3.vector))
    return Vector3Stamped(header=transform.header, vector=Vector3(x=x, y=y, z=z))


def do_transform_pose(pose: Pose, transform: TransformStamped) -> Pose:
    """Return a pose in the transform's frame; w of its rotation is not negative."""
    x, y, z = _moved(pose.position, transform)
    orientation = _composed(transform.transform.rotation, pose.orientation)
    return Pose(position=Point(x=x, y=y, z=z), orientation=orientation)


def do_transform_pose_stamped(pose: PoseStamped, transform: TransformStamped) -> PoseStamped:
    """Return a pose in the transform's frame."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def do_transform_pose_with_covariance_stamped(
    pose: PoseWithCovarianceStamped, transform: TransformStamped
) -> PoseWithCovarianceStamped:
    """Return a pose and its covariance in the transform's frame."""
    result = PoseWithCovarianceStamped(header=transform.header)
    result.pose.pose = do_transform_pose(pose.pose.pose, transform)
    result.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return result


def do_transform_polygon_stamped(polygon: PolygonStamped, transform: TransformStamped) -> PolygonStamped:
    """Return a polygon in the transform's frame."""
    result = PolygonStamped(header=transform.header)
    moved = (_moved(point, transform) for point in polygon.polygon.points)
    result.polygon.points = [Point32(x=x, y=y, z=z) for x, y, z in moved]
    return result


def _vector(coordinates: _Coordinates) -> Vector:
    return coordinates.x, coordinates.y, coordinates.z


def _product(matrix: Matrix, vector: Vector) -> Vector:
    x, y, z = vector
    first, second, third = matrix
    return (
        first[0] * x + first[1] * y + first[2] * z,
        second[0] * x + second[1] * y + second[2] * z,
        third[0] * x + third[1] * y + third[2] * z,
    )


def _moved(point: _Coordinates, transform: TransformStamped) -> Vector:
    """Rotate a point, then translate it."""
    x, y, z = _product(_matrix(transform.transform.rotation), _vector(point))
    by = transform.transform.translation
    return x + by.x, y + by.y, z + by.z


def _turned(matrix: Matrix, numbers: Sequence[float]) -> list[float]:
    """Rotate six numbers: two vectors."""
    a, b, c, d, e, f = map(float, numbers)
    return [*_product(matrix, (a, b, c)), *_product(matrix, (d, e, f))]


def _matrix(rotation: Quaternion) -> Matrix:
    """The matrix of a rotation, whatever the length of the quaternion."""
    x, y, z, w = _unit(rotation)
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


def _composed(second: Quaternion, first: Quaternion) -> Quaternion:
    """The rotation that does `first`, then `second`; its w is not negative."""
    ax, ay, az, aw = _unit(second)
    bx, by, bz, bw = _unit(first)
    w = aw * bw - ax * bx - ay * by - az * bz
    sign = math.copysign(1.0, w)
    return Quaternion(
        x=sign * (aw * bx + ax * bw + ay * bz - az * by),
        y=sign * (aw * by + ay * bw + az * bx - ax * bz),
        z=sign * (aw * bz + az * bw + ax * by - ay * bx),
        w=sign * w,
    )


def _unit(rotation: Quaternion) -> tuple[float, float, float, float]:
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    length = math.hypot(x, y, z, w)
    return (x / length, y / length, z / length, w / length) if length else (0.0, 0.0, 0.0, 1.0)


for _message in (Vector3Stamped, PoseStamped, PointStamped):
    ConvertRegistration().add_to_msg(_message, to_msg_msg)
    ConvertRegistration().add_from_msg(_message, from_msg_msg)
_transforms = TransformRegistration()
_transforms.add(PointStamped, do_transform_point)
_transforms.add(Vector3Stamped, do_transform_vector3)
_transforms.add(PoseStamped, do_transform_pose_stamped)
_transforms.add(PoseWithCovarianceStamped, do_transform_pose_with_covariance_stamped)
_transforms.add(PolygonStamped, do_transform_polygon_stamped)

"""Rotations and planar poses: small functions on numpy arrays.

Matrices are 3 x 3 and turn vectors of the inner frame into the outer one. Quaternions are (x, y, z, w), as in
geometry_msgs. A planar pose is (x, y, yaw). Angles are in radians.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def wrap(angle: float) -> float:
    """The same angle, within -pi to pi."""
    return math.atan2(math.sin(angle), math.cos(angle))


def rotation_x(angle: float) -> Array:
    """The matrix that turns about x."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def rotation_y(angle: float) -> Array:
    """The matrix that turns about y."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rotation_z(angle: float) -> Array:
    """The matrix that turns about z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """The matrix that turns about x, then y, then z of the outer frame, like URDF's rpy."""
    return rotation_z(yaw) @ rotation_y(pitch) @ rotation_x(roll)


def rotation_vector(vector: Array) -> Array:
    """The matrix that turns about a vector (3,) by its length."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = vector / angle
    k: Array = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k)


def vector_of(matrix: Array) -> Array:
    """The rotation vector (3,) of a matrix; its length is 0 to pi."""
    x, y, z, w = quaternion_of(matrix)
    if w < 0:
        x, y, z, w = -x, -y, -z, -w
    length = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 if length < 1e-9 else 2 * math.atan2(length, w) / length
    return np.array([x, y, z]) * scale


def matrix_of(quaternion: Array) -> Array:
    """The matrix of a quaternion of unit length."""
    x, y, z, w = (float(part) for part in quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_of(matrix: Array) -> Array:
    """The quaternion of a rotation matrix, computed from its largest component (Shepperd's method)."""
    trace = matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
    squares = (matrix[0, 0], matrix[1, 1], matrix[2, 2], trace)
    largest = max(range(4), key=lambda i: squares[i])
    quaternion = np.empty(4)
    if largest == 3:
        quaternion[3] = 1 + trace
        quaternion[0] = matrix[2, 1] - matrix[1, 2]
        quaternion[1] = matrix[0, 2] - matrix[2, 0]
        quaternion[2] = matrix[1, 0] - matrix[0, 1]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        quaternion[i] = 1 + 2 * matrix[i, i] - trace
        quaternion[j] = matrix[j, i] + matrix[i, j]
        quaternion[k] = matrix[k, i] + matrix[i, k]
        quaternion[3] = matrix[k, j] - matrix[j, k]
    return quaternion / math.sqrt(float(quaternion @ quaternion))


def yaw_of(matrix: Array) -> float:
    """The heading of the x axis of a frame."""
    return math.atan2(matrix[1, 0], matrix[0, 0])


def cross(a: Array, b: Array) -> Array:
    """The cross product of two vectors (3,); numpy's own takes ten times as long for such small arrays."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def to_frame(pose: Array, point: Array) -> Array:
    """A point (2,) as seen from a planar pose (3,)."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    x, y = point[0] - pose[0], point[1] - pose[1]
    return np.array([c * x + s * y, c * y - s * x])


def from_frame(pose: Array, point: Array) -> Array:
    """A point (2,) in the outer frame, given as seen from a planar pose (3,)."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return np.array([pose[0] + c * point[0] - s * point[1], pose[1] + s * point[0] + c * point[1]])

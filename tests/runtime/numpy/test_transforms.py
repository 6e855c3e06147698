"""4 x 4 matrices: quaternions as tf2 has them, both ways, and what is no rotation."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ifgen_runtime import ConversionError
from ifgen_runtime.numpy import from_transform_matrix, transform_matrix

RANDOM = np.random.default_rng(5)
NAMES = [
    "Transform",
    "Pose",
    "TransformStamped",
    "PoseStamped",
    "PoseWithCovariance",
    "PoseWithCovarianceStamped",
]


def parts(message: Any) -> tuple[Any, Any]:
    """The place and the rotation."""
    while not hasattr(message, "rotation") and not hasattr(message, "orientation"):
        message = message.transform if hasattr(message, "transform") else message.pose
    if hasattr(message, "rotation"):
        return message.translation, message.rotation
    return message.position, message.orientation


def rotated(quaternion: Any, vector: Any) -> Any:
    """Q v q*, by the products of quaternions, with the real part first."""

    def product(a: Any, b: Any) -> Any:
        return np.array(
            [a[0] * b[0] - a[1:] @ b[1:], *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))]
        )

    q = np.roll(quaternion, 1)
    return product(product(q, np.array([0, *vector])), q * (1, -1, -1, -1))[1:]


@pytest.mark.parametrize("name", NAMES)
def test_there_and_back(msg: SimpleNamespace, name: str) -> None:
    for _ in range(20):
        quaternion = RANDOM.standard_normal(4)
        quaternion /= np.linalg.norm(quaternion)
        vector = RANDOM.standard_normal(3)
        message = getattr(msg, name)()
        place, rotation = parts(message)
        place.x, place.y, place.z = vector.tolist()
        rotation.x, rotation.y, rotation.z, rotation.w = quaternion.tolist()
        matrix = transform_matrix(message)
        point = RANDOM.standard_normal(3)
        np.testing.assert_allclose(
            matrix @ [*point, 1], [*(rotated(quaternion, point) + vector), 1], atol=1e-14
        )
        again = from_transform_matrix(getattr(msg, name), matrix)
        place, rotation = parts(again)
        assert [place.x, place.y, place.z] == vector.tolist()
        expected = quaternion * math.copysign(1, quaternion[3])
        np.testing.assert_allclose([rotation.x, rotation.y, rotation.z, rotation.w], expected, atol=1e-14)
        assert all(type(getattr(rotation, axis)) is float for axis in "xyzw")


@pytest.mark.parametrize("axis", range(3))
def test_rotations_by_half_a_turn(msg: SimpleNamespace, axis: int) -> None:
    diagonal = -np.ones(4)
    diagonal[[axis, 3]] = 1
    pose = from_transform_matrix(msg.Pose, np.diag(diagonal))
    found = [pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w]
    np.testing.assert_allclose(np.abs(found), np.eye(4)[axis], atol=1e-15)
    np.testing.assert_allclose(transform_matrix(pose), np.diag(diagonal), atol=1e-15)


def test_a_quarter_turn_to_the_left_takes_x_to_y(msg: SimpleNamespace) -> None:
    half = np.float64(math.sqrt(0.5))
    turn = msg.Transform(translation=msg.Vector3(x=0.1), rotation=msg.Quaternion(z=half, w=half))
    np.testing.assert_allclose(transform_matrix(turn) @ [1, 0, 0, 1], [0.1, 1, 0, 1], atol=1e-15)


def test_headers_and_frames(msg: SimpleNamespace) -> None:
    header = msg.Header(frame_id="map")
    transform = from_transform_matrix(
        msg.TransformStamped, np.eye(4), header=header, child_frame_id="base_link"
    )
    assert (transform.header, transform.child_frame_id, transform.transform) == (
        header,
        "base_link",
        msg.Transform(),
    )
    with pytest.raises(
        TypeError, match="got geometry_msgs/msg/PoseStamped, which has no field 'child_frame_id'"
    ):
        from_transform_matrix(msg.PoseStamped, np.eye(4), child_frame_id="base_link")
    with pytest.raises(TypeError, match=r"got geometry_msgs/msg/Twist$"):
        from_transform_matrix(msg.Twist, np.eye(4))
    with pytest.raises(TypeError, match=r"got sensor_msgs/msg/Imu$"):
        transform_matrix(msg.Imu())


def test_a_quaternion_is_normalised_within_the_tolerance_of_tf2(msg: SimpleNamespace) -> None:
    matrix = transform_matrix(msg.Pose(orientation=msg.Quaternion(x=0.6, w=0.804)))
    np.testing.assert_allclose(matrix[:3, :3].T @ matrix[:3, :3], np.eye(3), atol=1e-15)
    for numbers, length in (
        ((0.0, 0.0, 0.0, 0.0), "0"),
        ((0.0, 0.0, 0.1, 1.0), "1.00499"),
        ((1e200,) * 4, "inf"),
    ):
        pose = msg.PoseStamped()
        q = pose.pose.orientation
        q.x, q.y, q.z, q.w = numbers
        with pytest.raises(
            ConversionError,
            match=rf"^PoseStamped\.pose\.orientation: expected a unit quaternion, got length {length};",
        ):
            transform_matrix(pose)


@pytest.mark.parametrize("value", [math.nan, math.inf, None, "1", 10**400])
def test_numbers_that_are_not_finite(msg: SimpleNamespace, value: Any) -> None:
    for attribute, path in (("translation", r"translation\.x"), ("rotation", r"rotation\.x")):
        message = msg.TransformStamped()
        getattr(message.transform, attribute).x = value
        with pytest.raises(
            ConversionError,
            match=rf"^TransformStamped\.transform\.{path}: expected a finite number, got ",
        ):
            transform_matrix(message)


@pytest.mark.parametrize(
    ("matrix", "error"),
    [
        (np.eye(3), r"Pose: expected a finite matrix of shape \(4, 4\), got float64 and shape \(3, 3\)"),
        (np.full((4, 4), math.nan), r"Pose: expected a finite matrix of shape \(4, 4\), got"),
        (
            np.diag([1, 1, 1, 2]),
            r"Pose: expected 0, 0, 0, 1 in the last row of the matrix, got \[0\.0, 0\.0, 0\.0, 2\.0\]",
        ),
        (np.diag([1, 1, -1, 1]), r"Pose\.orientation: the upper left of the matrix is no rotation"),
        (np.diag([1.01, 1, 1, 1]), r"Pose\.orientation: the upper left of the matrix is no rotation"),
        (
            np.zeros((4, 4)) + np.diag([0, 0, 0, 1]),
            r"Pose\.orientation: the upper left of the matrix is no rotation",
        ),
    ],
)
def test_a_matrix_that_is_no_transform(msg: SimpleNamespace, matrix: Any, error: str) -> None:
    with pytest.raises(ConversionError, match=f"^{error}"):
        from_transform_matrix(msg.Pose, matrix)
    assert from_transform_matrix(msg.Pose, np.eye(4, dtype=np.float32)) == msg.Pose()

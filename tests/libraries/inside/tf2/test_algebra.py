"""tf2 against matrices: what numpy says of the same transforms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import (
    Point,
    Point32,
    PointStamped,
    Polygon,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    Transform,
    TransformStamped,
    Vector3,
    Vector3Stamped,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.time import Time
from std_msgs.msg import Header
from tf2_geometry_msgs import (
    do_transform_point,
    do_transform_polygon_stamped,
    do_transform_pose,
    do_transform_pose_stamped,
    do_transform_pose_with_covariance_stamped,
    do_transform_vector3,
)
from tf2_py import BufferCore

LATEST = Time()
coordinates = st.floats(-100.0, 100.0).map(lambda value: round(value, 3))
vectors = st.tuples(coordinates, coordinates, coordinates)
units = st.floats(-1.0, 1.0)
# Any length but nearly none: senders rarely normalise to the last digit.
quaternions = st.tuples(units, units, units, units).filter(lambda q: math.hypot(*q) > 0.1)
transforms = st.builds(
    lambda t, q: Transform(
        translation=Vector3(x=t[0], y=t[1], z=t[2]), rotation=Quaternion(x=q[0], y=q[1], z=q[2], w=q[3])
    ),
    vectors,
    quaternions,
)


def rotation_matrix(q: Any) -> np.ndarray:
    """By Rodrigues' formula, from the axis and the angle."""
    axis = np.array([q.x, q.y, q.z]) / math.hypot(q.x, q.y, q.z, q.w)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        return np.eye(3)
    angle = 2.0 * math.atan2(sine, q.w / math.hypot(q.x, q.y, q.z, q.w))
    x, y, z = axis / sine
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def matrix(transform: Any) -> np.ndarray:
    result = np.eye(4)
    result[:3, :3] = rotation_matrix(transform.rotation)
    result[:3, 3] = transform.translation.x, transform.translation.y, transform.translation.z
    return result


def stamped(parent: str, child: str, transform: Any, stamp: float = 1.0) -> TransformStamped:
    header = Header(frame_id=parent, stamp=Time(nanoseconds=round(stamp * 1e9)).to_msg())
    return TransformStamped(header=header, child_frame_id=child, transform=transform)


def same(found: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * max(1.0, float(np.abs(expected).max())))


trees = st.lists(st.tuples(st.integers(0, 7), transforms), min_size=1, max_size=8)


@given(trees)
@settings(max_examples=60)
def test_lookups_are_products_of_matrices(tree: list[tuple[int, Any]]) -> None:
    """Each frame's parent is one before it: chains, stars and all between."""
    buffer = BufferCore()
    to_root = [np.eye(4)]
    for index, (parent, transform) in enumerate(tree, 1):
        above = parent % index
        buffer.set_transform(stamped(f"f{above}", f"f{index}", transform), "test")
        to_root.append(to_root[above] @ matrix(transform))
    for target in range(len(to_root)):
        for source in range(len(to_root)):
            found = buffer.lookup_transform_core(f"f{target}", f"f{source}", LATEST)
            same(matrix(found.transform), np.linalg.inv(to_root[target]) @ to_root[source])
            rotation = found.transform.rotation
            assert math.hypot(rotation.x, rotation.y, rotation.z, rotation.w) == pytest.approx(1.0, abs=1e-12)


@given(transforms, transforms, st.floats(0.0, 1.0))
@settings(max_examples=100)
def test_between_two_times_a_frame_moves_straight_and_turns_steadily(
    first: Any, second: Any, ratio: float
) -> None:
    buffer = BufferCore()
    buffer.set_transform(stamped("map", "base", first, 10.0), "test")
    buffer.set_transform(stamped("map", "base", second, 10.1), "test")
    at = 10_000_000_000 + round(ratio * 100_000_000)
    ratio = (at - 10_000_000_000) / 100_000_000
    found = matrix(buffer.lookup_transform_core("map", "base", Time(nanoseconds=at)).transform)
    old, new = matrix(first), matrix(second)
    same(found[:3, 3], (1 - ratio) * old[:3, 3] + ratio * new[:3, 3])

    def angle(a: np.ndarray, b: np.ndarray) -> float:
        # The distance of rotations; the cosine alone loses digits for small angles.
        half = float(np.linalg.norm(a - b)) / (2 * math.sqrt(2))
        return 2 * math.asin(min(1.0, half))

    whole = angle(old[:3, :3], new[:3, :3])
    if whole < 3.1:  # else both ways round are as short
        assert angle(old[:3, :3], found[:3, :3]) == pytest.approx(ratio * whole, abs=1e-6)
        assert angle(found[:3, :3], new[:3, :3]) == pytest.approx((1 - ratio) * whole, abs=1e-6)


@given(transforms, transforms, transforms)
@settings(max_examples=30)
def test_a_fixed_frame_connects_two_times(first: Any, second: Any, arm: Any) -> None:
    buffer = BufferCore()
    buffer.set_transform(stamped("odom", "base", first, 1.0), "test")
    buffer.set_transform(stamped("odom", "base", second, 2.0), "test")
    buffer.set_transform_static(stamped("base", "arm", arm), "test")
    found = buffer.lookup_transform_full_core("base", Time(seconds=2), "arm", Time(seconds=1), "odom")
    same(matrix(found.transform), np.linalg.inv(matrix(second)) @ matrix(first) @ matrix(arm))
    assert found.header.stamp == Time(seconds=2).to_msg()


@given(transforms, transforms, vectors)
@settings(max_examples=60)
def test_messages_are_moved_as_matrices_move_them(transform: Any, other: Any, vector: Any) -> None:
    by = stamped("map", "camera", transform)
    moves, turns = matrix(transform), matrix(transform)[:3, :3]
    x, y, z = vector
    expected = (moves @ [x, y, z, 1.0])[:3]

    point = do_transform_point(PointStamped(point=Point(x=x, y=y, z=z)), by)
    same(np.array([point.point.x, point.point.y, point.point.z]), expected)
    arrow = do_transform_vector3(Vector3Stamped(vector=Vector3(x=x, y=y, z=z)), by)
    same(np.array([arrow.vector.x, arrow.vector.y, arrow.vector.z]), turns @ [x, y, z])
    polygon = PolygonStamped(polygon=Polygon(points=[Point32(x=x, y=y, z=z)] * 2))
    corner = do_transform_polygon_stamped(polygon, by).polygon.points[1]
    np.testing.assert_allclose([corner.x, corner.y, corner.z], expected, rtol=1e-5, atol=1e-4)

    pose = Pose(position=Point(x=x, y=y, z=z), orientation=other.rotation)
    moved = do_transform_pose(pose, by)
    same(np.array([moved.position.x, moved.position.y, moved.position.z]), expected)
    same(rotation_matrix(moved.orientation), turns @ rotation_matrix(other.rotation))
    assert moved.orientation.w >= 0.0
    stamped_pose = do_transform_pose_stamped(PoseStamped(pose=pose), by)
    assert stamped_pose.pose == moved
    for result in (point, arrow, stamped_pose):
        assert result.header == by.header
    assert (
        by.transform == transform
    )  # upstream's do_transform_vector3 forgets the translation of its argument


@given(transforms, st.integers(0, 1000))
@settings(max_examples=30)
def test_both_axes_of_a_covariance_are_rotated(transform: Any, seed: int) -> None:
    root = np.random.default_rng(seed).normal(size=(6, 6))
    covariance = root @ root.T
    pose = PoseWithCovarianceStamped()
    pose.pose.covariance = [float(value) for value in covariance.flat]
    moved = do_transform_pose_with_covariance_stamped(pose, stamped("map", "camera", transform))
    turn = np.kron(np.eye(2), matrix(transform)[:3, :3])
    same(np.array(moved.pose.covariance).reshape(6, 6), turn @ covariance @ turn.T)

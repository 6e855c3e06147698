"""Buffers transform messages, and what is registered for it."""

from __future__ import annotations

from typing import Any

import pytest
import tf2_geometry_msgs
import tf2_ros
from geometry_msgs.msg import PointStamped, PoseStamped, PoseWithCovarianceStamped, Quaternion, Vector3Stamped
from rclpy.duration import Duration
from rclpy.time import Time
from std_msgs.msg import String
from tf2_geometry_msgs import TransformStamped

STAMP = Time(seconds=2)
ROWS = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0) * 6


@pytest.fixture
def buffer() -> tf2_ros.Buffer:
    """A buffer in which b is 1 m in front of a, and upside down."""
    buffer = tf2_ros.Buffer()
    transform = TransformStamped(child_frame_id="b")
    transform.header.frame_id, transform.header.stamp = "a", STAMP.to_msg()
    transform.transform.translation.x = 1.0
    transform.transform.rotation = Quaternion(x=1.0, y=0.0, z=0.0, w=0.0)
    buffer.set_transform(transform, "test")
    return buffer


def stamped(message: Any) -> Any:
    message.header.frame_id, message.header.stamp = "a", STAMP.to_msg()
    return message


def xyz(message: Any) -> tuple[float, float, float]:
    return message.x, message.y, message.z


def place(message: Any) -> Any:
    message.x, message.y, message.z = 1.0, 2.0, 3.0


def test_each_type_is_transformed(buffer: tf2_ros.Buffer) -> None:
    point = stamped(PointStamped())
    place(point.point)
    moved = buffer.transform(point, "b", new_type=PointStamped)
    assert xyz(moved.point) == (0.0, -2.0, -3.0)
    assert moved.header.frame_id == "b" and moved.header.stamp == STAMP.to_msg()
    arrow = stamped(Vector3Stamped())
    place(arrow.vector)
    assert xyz(buffer.transform(arrow, "b", Duration(seconds=0.1)).vector) == (1.0, -2.0, -3.0)
    pose = stamped(PoseStamped())
    place(pose.pose.position)
    pose.pose.orientation = Quaternion(x=1.0, y=0.0, z=0.0, w=0.0)
    moved = buffer.transform(pose, "b")
    assert xyz(moved.pose.position) == (0.0, -2.0, -3.0)
    assert moved.pose.orientation == Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)
    assert buffer.transform_full(pose, "b", Time(), "a").pose == moved.pose


def test_a_covariance(buffer: tf2_ros.Buffer) -> None:
    pose = stamped(PoseWithCovarianceStamped())
    place(pose.pose.pose.position)
    pose.pose.covariance = list(ROWS)
    moved = buffer.transform(pose, "b")
    assert xyz(moved.pose.pose.position) == (0.0, -2.0, -3.0)
    first, second = (1.0, -2.0, -3.0, 4.0, -5.0, -6.0), (-1.0, 2.0, 3.0, -4.0, 5.0, 6.0)
    assert tuple(moved.pose.covariance) == (*first, *second, *second) * 2
    assert tuple(pose.pose.covariance) == ROWS


def test_a_rotation_without_length_does_not_rotate() -> None:
    pose = PoseStamped()
    pose.pose.orientation = Quaternion(x=0.0, y=0.0, z=0.0, w=0.0)
    moved = tf2_geometry_msgs.do_transform_pose_stamped(pose, TransformStamped())
    assert moved.pose.orientation == Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)


def test_types_that_nobody_registered(buffer: tf2_ros.Buffer) -> None:
    with pytest.raises(tf2_ros.TypeException, match="is not loaded or supported"):
        buffer.transform(String(), "b")  # type: ignore[arg-type]
    with pytest.raises(tf2_ros.TypeException) as caught:
        tf2_ros.convert(1, str)
    assert caught.value.errstr == "Type <class 'int'> is not loaded or supported"


def test_users_types() -> None:
    class Ball:
        def __init__(self, header: Any) -> None:
            self.header = header

    class Square(Ball):
        pass

    registration = tf2_ros.TransformRegistration()
    registration.add(Ball, lambda ball, transform: Ball(transform.header))
    conversions = tf2_ros.ConvertRegistration()
    conversions.add_to_msg(Ball, lambda ball: PointStamped(header=ball.header))
    conversions.add_from_msg(Square, lambda message: Square(message.header))
    buffer = tf2_ros.Buffer()
    ball = tf2_ros.Stamped(Ball(None), Time().to_msg(), "a")
    moved = buffer.transform(ball, "a", new_type=Square)
    assert type(moved) is Square and moved.header.frame_id == "a"
    conversions.add_convert((Ball, Square), lambda ball: "direct")
    assert buffer.transform(ball, "a", new_type=Square) == "direct"
    copy = tf2_ros.convert(PointStamped(), PointStamped)
    assert copy == PointStamped()


def test_messages_are_themselves() -> None:
    assert tf2_geometry_msgs.to_msg_msg(STAMP) is tf2_geometry_msgs.from_msg_msg(STAMP) is STAMP


def test_what_a_derived_class_lacks() -> None:
    interface = tf2_ros.BufferInterface()
    with pytest.raises(tf2_ros.NotImplementedException) as caught:
        interface.lookup_transform("a", "b", Time())
    assert caught.value.errstr == "CanTransform or LookupTransform not implemented"

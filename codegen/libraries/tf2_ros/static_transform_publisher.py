"""The program `static_transform_publisher`: one transform that never changes."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.utilities import remove_ros_args

from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster

_ANGLES = ("roll", "pitch", "yaw")
_QUATERNION = ("qx", "qy", "qz", "qw")


def transform_of(words: Sequence[str]) -> TransformStamped:
    """Return the transform that arguments describe. Raises SystemExit with a message for wrong ones."""
    parser = argparse.ArgumentParser(
        "static_transform_publisher",
        description="Publish a transform that never changes, from a frame to a child frame.",
        epilog="Angles are in rad and lengths in m. What is not given is 0.",
    )
    old = _old_style(words)
    for name in ("x", "y", "z", *_ANGLES, *_QUATERNION):
        parser.add_argument(f"--{name}", type=float)
    parser.add_argument("--frame-id", required=True)
    parser.add_argument("--child-frame-id", required=True)
    given = parser.parse_args(_joined(words) if old is None else old)
    has_angles = any(getattr(given, name) is not None for name in _ANGLES)
    has_quaternion = any(getattr(given, name) is not None for name in _QUATERNION)
    if has_angles and has_quaternion:
        parser.error("give either --roll, --pitch and --yaw, or --qx, --qy, --qz and --qw")
    if given.frame_id == given.child_frame_id:
        parser.error(f"cannot publish static transform from '{given.frame_id}' to '{given.child_frame_id}'")
    found = TransformStamped()
    found.header.frame_id, found.child_frame_id = given.frame_id, given.child_frame_id
    at, turned = found.transform.translation, found.transform.rotation
    at.x, at.y, at.z = (getattr(given, name) or 0.0 for name in "xyz")
    if has_quaternion:
        values = [getattr(given, name) or 0.0 for name in _QUATERNION]
        length = math.hypot(*values)
        if not length:
            parser.error("the quaternion is 0, which is no rotation")
        turned.x, turned.y, turned.z, turned.w = (value / length for value in values)
    else:
        turned.x, turned.y, turned.z, turned.w = _quaternion(*(getattr(given, n) or 0.0 for n in _ANGLES))
    return found


def _old_style(words: Sequence[str]) -> list[str] | None:
    """Return the arguments for x y z yaw pitch roll FRAME CHILD, or x y z qx qy qz qw FRAME CHILD."""
    names = {8: ("x", "y", "z", "yaw", "pitch", "roll"), 9: ("x", "y", "z", *_QUATERNION)}.get(len(words))
    if names is None or any(word.startswith("--") for word in words):
        return None
    options = [f"--{name}={word}" for name, word in zip(names, words, strict=False)]
    return [*options, f"--frame-id={words[-2]}", f"--child-frame-id={words[-1]}"]


def _joined(words: Sequence[str]) -> list[str]:
    """Return arguments with `=` before each negative value, which looks like an option otherwise."""
    joined: list[str] = []
    for word in words:
        if joined and word[:2].strip("-.").isdigit() and joined[-1].startswith("--"):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Rotations about the fixed axes x, y and z, in this order [rad]."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(a / 2), math.cos(a / 2)) for a in (roll, pitch, yaw))
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def main(args: Sequence[str] | None = None) -> int:
    """Publish the transform until somebody ends the program."""
    whole = list(sys.argv if args is None else args)
    words = remove_ros_args(whole)[1:]
    transform = transform_of(words)
    rclpy.init(args=whole)
    node = Node("static_transform_publisher")
    if _old_style(words) is not None:
        node.get_logger().warning("Old-style arguments are deprecated; see --help for new-style arguments")
    transform.header.stamp = node.get_clock().now().to_msg()
    StaticTransformBroadcaster(node).sendTransform(transform)
    at, turned = transform.transform.translation, transform.transform.rotation
    node.get_logger().info(
        "Spinning until stopped - publishing transform\n"
        f"translation: ('{at.x:f}', '{at.y:f}', '{at.z:f}')\n"
        f"rotation: ('{turned.x:f}', '{turned.y:f}', '{turned.z:f}', '{turned.w:f}')\n"
        f"from '{transform.header.frame_id}' to '{transform.child_frame_id}'"
    )
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())

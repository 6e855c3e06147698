"""Messages of ROS and values of the tree, converted both ways; checks of the names of frames."""

from __future__ import annotations

import math
from collections.abc import Container, Iterator
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from geometry_msgs.msg import Transform as TransformMessage
from rclpy.logging import get_logger
from std_msgs.msg import Header

from tf2_py.exceptions import InvalidArgumentException, LookupException
from tf2_py.transforms import Transform, normalized


def require(frame: Any, known: Container[str], place: str) -> None:
    """Refuse a name that a lookup cannot use; `place` is where it comes from.

    :raises InvalidArgumentException: if no frame can have such a name.
    :raises LookupException: if no frame has it.
    :raises TypeError: if it is not a string.
    """
    if wrong := _wrong(frame):
        raise InvalidArgumentException(
            f'Invalid argument "{frame}" passed to {place} - in tf2 frame_ids cannot {wrong}'
        )
    if frame not in known:
        raise LookupException(f'"{frame}" passed to {place} does not exist. ')


def complaint(known: Container[str], **frames: Any) -> str:
    """Return the first thing that is wrong with names; empty if they are right.

    :raises TypeError: if one is not a string.
    """
    for argument, frame in frames.items():
        wrong = _wrong(frame)
        if wrong or frame not in known:
            why = f"in tf2 frame_ids cannot {wrong}" if wrong else "frame does not exist"
            return f'Invalid frame ID "{frame}" passed to canTransform argument {argument} - {why}'
    return ""


def _wrong(frame: Any) -> str:
    if not isinstance(frame, str):
        raise TypeError(f"the name of a frame must be a str, got {frame!r}")
    if not frame:
        return "be empty"
    return "start with a '/'" if frame[0] == "/" else ""


NANOSECONDS = 10**9
_logger = get_logger("tf2")


def to_nanoseconds(value: Any, what: str = "time") -> int:
    """Return a time or a duration in nanoseconds: a message, or rclpy's.

    :raises TypeError: if it is neither.
    """
    if hasattr(value, "nanoseconds"):
        nanoseconds: int = value.nanoseconds
        return nanoseconds
    if hasattr(value, "sec") and hasattr(value, "nanosec"):
        total: int = value.sec * NANOSECONDS + value.nanosec
        return total
    raise TypeError(f"{what} must have sec and nanosec, or nanoseconds.")


def to_message(target: str, source: str, transform: Transform, stamp: int) -> TransformStamped:
    """Return what a lookup returns."""
    x, y, z, qx, qy, qz, qw = transform
    sec, nanosec = divmod(stamp, NANOSECONDS)
    return TransformStamped(
        header=Header(stamp=Time(sec=sec, nanosec=nanosec), frame_id=target),
        child_frame_id=source,
        transform=TransformMessage(
            translation=Vector3(x=x, y=y, z=z), rotation=Quaternion(x=qx, y=qy, z=qz, w=qw)
        ),
    )


def checked_transform(message: TransformStamped, authority: str) -> tuple[str, str, Transform] | None:
    """Return child, parent and transform of a message.

    :returns: None if it makes no sense; why is in the log.
    """
    translation, rotation = message.transform.translation, message.transform.rotation
    parent = message.header.frame_id.removeprefix("/")
    child = message.child_frame_id.removeprefix("/")
    given: Transform = (
        translation.x, translation.y, translation.z,
        rotation.x, rotation.y, rotation.z, rotation.w,
    )  # fmt: skip
    transform = normalized(given)
    is_number = not any(map(math.isnan, given[:3]))
    if transform is not None and is_number and child and parent and child != parent:
        return child, parent, transform
    for error in _errors(child, parent, given, authority):
        _logger.error(error)
    return None


def _errors(child: str, parent: str, given: Transform, authority: str) -> Iterator[str]:
    if child == parent:
        yield (
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id and  '
            f'child_frame_id "{child}" because they are the same'
        )
    if not child:
        yield (
            f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" '
            "because child_frame_id not set "
        )
    if not parent:
        yield (
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority "{authority}" '
            "because frame_id not set"
        )
    x, y, z, rotation = " ".join(f"{value:f}" for value in given).split(" ", 3)
    head = f'Ignoring transform for child_frame_id "{child}" from authority "{authority}" because of'
    if any(map(math.isnan, given)):
        yield f"TF_NAN_INPUT: {head} a nan value in the transform ({x} {y} {z}) ({rotation})"
    elif normalized(given) is None:
        yield f"TF_DENORMALIZED_QUATERNION: {head} an invalid quaternion in the transform ({rotation})"


def report_old(child: str, stamp: str, authority: str) -> None:
    """Log that a transform is older than the buffer goes back."""
    _logger.warning(
        f"TF_OLD_DATA ignoring data from the past for frame {child} at time {stamp} according to authority "
        f"{authority}\nPossible reasons are listed at http://wiki.ros.org/tf/Errors%20explained"
    )

"""The interface of all sources of transforms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from rclpy.duration import Duration
from std_msgs.msg import Header

from tf2_ros.registration import ConvertRegistration, TransformRegistration, TypeException, convert

if TYPE_CHECKING:
    from builtin_interfaces.msg import Time
    from geometry_msgs.msg import TransformStamped
    from tf2_py.buffer_core import TimeLike

__all__ = [
    "BufferInterface",
    "ConvertRegistration",
    "NotImplementedException",
    "Stamped",
    "TransformRegistration",
    "TypeException",
    "convert",
]

StampedObject = TypeVar("StampedObject")


class HasHeader(Protocol):
    """An object that can be transformed."""

    header: Any  # std_msgs/Header


class BufferInterface:
    """Transforms objects with a header; derived classes know where transforms come from."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self,
        object_stamped: HasHeader,
        target_frame: str,
        timeout: Duration = Duration(),  # noqa: B008 - never changes
        new_type: type[Any] | None = None,
    ) -> Any:
        """Return an object in the target frame, at the time of its header.

        :param timeout: how long to wait for the transform.
        :param new_type: a type to convert the result to.
        :raises TypeException: if nothing is registered for the type; import the package that does it, such as
            `tf2_geometry_msgs`.
        :raises TransformException: as `lookup_transform`.
        """
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        transform = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        result = do_transform(object_stamped, transform)
        return result if new_type is None else convert(result, new_type)

    def transform_full(
        self,
        object_stamped: HasHeader,
        target_frame: str,
        target_time: TimeLike,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
        new_type: type[Any] | None = None,
    ) -> Any:
        """Return an object in the target frame at another time; the fixed frame does not move in between."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        transform = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        result = do_transform(object_stamped, transform)
        return result if new_type is None else convert(result, new_type)

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: TimeLike,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> TransformStamped:
        """Return the transform that takes coordinates in the source frame to the target frame.

        :param time: a time; zero asks for the latest.
        :param timeout: how long to wait for it.
        """
        raise NotImplementedException

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> TransformStamped:
        """Return the transform between two frames at two times; the fixed frame does not move in between."""
        raise NotImplementedException

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: TimeLike,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> Any:
        """Return whether there is a transform between two frames."""
        raise NotImplementedException

    def can_transform_full(
        self,
        target_frame: str,
        target_time: TimeLike,
        source_frame: str,
        source_time: TimeLike,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> Any:
        """Return whether there is a transform between two frames at two times."""
        raise NotImplementedException


def Stamped(obj: StampedObject, stamp: Time, frame_id: str) -> StampedObject:
    """Give an object a header, and return it."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)  # type: ignore[attr-defined] # added here
    return obj


class NotImplementedException(Exception):
    """A derived class of `BufferInterface` lacks a method."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"
        super().__init__(self.errstr)

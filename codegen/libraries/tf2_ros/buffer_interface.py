"""The interface of all sources of transforms, and which functions transform objects of a type."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeAlias, TypeVar

from rclpy.duration import Duration
from std_msgs.msg import Header

if TYPE_CHECKING:
    from builtin_interfaces.msg import Time
    from geometry_msgs.msg import TransformStamped
    from tf2_py.buffer_core import TimeLike


# Takes an object and the transform from its frame, and returns it in the transform's frame.
TransformFunction: TypeAlias = Callable[[Any, "TransformStamped"], Any]
Key = TypeVar("Key")
Function = TypeVar("Function")


class TypeException(Exception):
    """Nothing is registered for a type."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class TransformRegistration:
    """Which function transforms objects of a type. All instances share one table."""

    __type_map: ClassVar[dict[type[Any], TransformFunction]] = {}

    def print_me(self) -> None:
        """Print the table."""
        print(self.__type_map)

    def add(self, key: type[Any], callback: TransformFunction) -> None:
        """Register a function for a type."""
        self.__type_map[key] = callback

    def get(self, key: type[Any]) -> TransformFunction:
        """Return the function for a type.

        :raises TypeException: if there is none.
        """
        return _registered(self.__type_map, key)


class ConvertRegistration:
    """Which functions convert between types. All instances share one table."""

    __to_msg_map: ClassVar[dict[type[Any], Callable[[Any], Any]]] = {}
    __from_msg_map: ClassVar[dict[type[Any], Callable[[Any], Any]]] = {}
    __convert_map: ClassVar[dict[tuple[type[Any], type[Any]], Callable[[Any], Any]]] = {}

    def add_from_msg(self, key: type[Any], callback: Callable[[Any], Any]) -> None:
        """Register what makes a type from a message."""
        self.__from_msg_map[key] = callback

    def add_to_msg(self, key: type[Any], callback: Callable[[Any], Any]) -> None:
        """Register what makes a message from a type."""
        self.__to_msg_map[key] = callback

    def add_convert(self, key: tuple[type[Any], type[Any]], callback: Callable[[Any], Any]) -> None:
        """Register what makes the second type from the first."""
        self.__convert_map[key] = callback

    def get_from_msg(self, key: type[Any]) -> Callable[[Any], Any]:
        """Return what makes a type from a message."""
        return _registered(self.__from_msg_map, key)

    def get_to_msg(self, key: type[Any]) -> Callable[[Any], Any]:
        """Return what makes a message from a type."""
        return _registered(self.__to_msg_map, key)

    def get_convert(self, key: tuple[type[Any], type[Any]]) -> Callable[[Any], Any]:
        """Return what makes the second type from the first."""
        return _registered(self.__convert_map, key)


def _registered(table: dict[Key, Function], key: Key) -> Function:
    if key not in table:
        raise TypeException(f"Type {key} is not loaded or supported")
    return table[key]


def convert(a: object, b_type: type[Any]) -> Any:
    """Return an object as another type: by a function for both, as a copy, or over a message.

    :raises TypeException: if nothing is registered for it.
    """
    registration = ConvertRegistration()
    a_type = type(a)
    try:
        direct = registration.get_convert((a_type, b_type))
    except TypeException:
        if a_type is b_type:
            return deepcopy(a)
        to_message = registration.get_to_msg(a_type)
        return registration.get_from_msg(b_type)(to_message(a))
    return direct(a)


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

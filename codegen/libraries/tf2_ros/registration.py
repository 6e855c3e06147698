"""Which functions transform and convert objects of a type."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped

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

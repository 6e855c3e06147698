"""Messages to bytes and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport
from rclpy.type_support import check_for_type_support

if not TYPE_CHECKING:
    __getattr__ = reexport(__name__)

_MsgType = TypeVar("_MsgType")


def serialize_message(message: Any) -> bytes:
    """Return a message as CDR bytes, encapsulation header included.

    Raises AttributeError for what is not a message, SerializationError (a ValueError) for a bad field value.
    """
    message_type = type(message)
    check_for_type_support(message_type)
    return _rclpy.rclpy_serialize(message, message_type)


def deserialize_message(serialized_message: bytes, message_type: type[_MsgType]) -> _MsgType:
    """Return the message that CDR bytes hold, in either byte order; RMWError if they do not fit the type."""
    check_for_type_support(message_type)
    return _rclpy.rclpy_deserialize(serialized_message, message_type)  # type: ignore[no-any-return]

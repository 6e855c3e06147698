"""Messages to bytes and back."""

from __future__ import annotations

from typing import Any

from rmw_local.message import DecodeError, message_type

from .errors import RMWError


def rclpy_serialize(pymsg: Any, pymsg_type: type[Any]) -> bytes:
    """Return a message as CDR bytes with their encapsulation header."""
    return message_type(pymsg_type).serialize(pymsg)


def rclpy_deserialize(pybuffer: bytes, pymsg_type: type[Any]) -> Any:
    """Return the message that CDR bytes hold, in either byte order; RMWError if they do not fit."""
    if not isinstance(pybuffer, bytes):
        raise TypeError(f"rclpy_deserialize(buffer: bytes, type): got {pybuffer!r}")
    try:
        return message_type(pymsg_type).deserialize(pybuffer)
    except DecodeError as error:
        raise RMWError(f"failed to deserialize ROS message: {error}") from None

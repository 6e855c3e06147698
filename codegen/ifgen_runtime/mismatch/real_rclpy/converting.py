"""Bytes of other definitions to our messages, and back."""

from __future__ import annotations

from typing import Any

from ifgen_runtime.adapters import adapter_for, decode
from ifgen_runtime.codec import serialize
from ifgen_runtime.codec.decoding import decode_any
from ifgen_runtime.errors import DeserializationError
from ifgen_runtime.mismatch.real_rclpy.carriers import carrier_of


def decoded(data: bytes, type_hash: str, cls: type[Any]) -> Any:
    """Our message in the bytes of the definition with this hash; None if they cannot be read.

    Raises what an adapter raises.
    """
    try:
        return decode(data, type_hash, cls)
    except DeserializationError:
        pass
    if type_hash != cls.__type_hash__:
        return None
    try:
        return decode_any(data, cls, bounded=False)  # compiled types receive what is over its bound, too
    except DeserializationError:
        return None


def encoded(message: Any, type_hash: str, cls: type[Any]) -> Any:
    """Make what rclpy is to send: our message, or a carrier of its bytes in another definition.

    Raises what an adapter raises, and SerializationError for a wrong value.
    """
    if type_hash == cls.__type_hash__:
        return message
    adapter = adapter_for(type_hash, cls)
    assert adapter is not None, "an adapter that was there is never unregistered"
    assert adapter.downgrade is not None, "without it, the other definition is refused"
    return carrier_of(cls)(serialize(adapter.downgrade(message)))

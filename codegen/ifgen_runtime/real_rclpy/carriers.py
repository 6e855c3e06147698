"""Bytes of other definitions to our messages, and back, and the classes of rclpy's C extension for guards.

Which definition a request or a response has is known when it has been taken. So it is taken as it came, as a
`Carrier` of its bytes, and decoded then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from ifgen_runtime.adapters import adapter_for, decode
from ifgen_runtime.codec import serialize
from ifgen_runtime.codec.decoding import decode_any
from ifgen_runtime.errors import DeserializationError
from ifgen_runtime.field_types import type_name
from ifgen_runtime.real_rclpy.binding import native
from ifgen_runtime.real_rclpy.layout import Description, split
from ifgen_runtime.real_rclpy.register import give, introspection_handle, type_tables
from ifgen_runtime.type_description import describe

if TYPE_CHECKING:
    from collections.abc import Mapping

    class _Handle:
        def __init__(self, node: Any, cls: type[Any], name: str, qos: Any) -> None:
            """Make it in rcl."""

        def destroy_when_not_in_use(self) -> None:
            """Destroy it in rcl, at the end of a call that uses it."""

    class Publisher(_Handle):
        """An `rcl_publisher_t`."""

        def get_topic_name(self) -> str:
            """The full name."""
            ...

        def publish(self, message: Any) -> None:
            """Publish a message."""

    class Subscription(_Handle):
        """An `rcl_subscription_t`."""

        def get_topic_name(self) -> str:
            """The full name."""
            ...

        def take_message(self, message_type: type[Any], raw: bool) -> tuple[Any, Mapping[str, Any]] | None:
            """The next message, or its bytes for `raw`, and what is known of it; None if there is none."""
            ...

    class Service(_Handle):
        """An `rcl_service_t`."""

        @property
        def name(self) -> str:
            """The full name."""
            ...

        def service_take_request(self, request_type: type[Any]) -> tuple[Any, Any]:
            """The next request and its header; None twice if there is none."""
            ...

        def service_send_response(self, response: Any, request_id: Any) -> None:
            """Send a response."""

    class Client(_Handle):
        """An `rcl_client_t`."""

        @property
        def service_name(self) -> str:
            """The full name."""
            ...

        def service_server_is_available(self) -> bool:
            """Whether a server is connected."""
            ...

        def send_request(self, request: Any) -> int:
            """Send a request, and return its number."""
            ...

        def take_response(self, response_type: type[Any]) -> tuple[Any, Any]:
            """The header and the next response; None twice if there is none."""
            ...

else:
    from rclpy.impl.implementation_singleton import rclpy_implementation

    Publisher = rclpy_implementation.Publisher
    Subscription = rclpy_implementation.Subscription
    Service = rclpy_implementation.Service
    Client = rclpy_implementation.Client


_ANY_LAYOUT: Final = (("R1 B0._first", b""),)  # a byte, which every body has: whatever follows is left over


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


class Carrier:
    """The bytes of a message, encapsulation included: rclpy takes and sends it as any other message."""

    __slots__ = ("data",)

    def __init__(self, data: bytes) -> None:
        self.data = data


_carriers: dict[type, type[Carrier]] = {}


def carrier_of(cls: type[Any]) -> type[Carrier]:
    """A class with the type support of another, whose messages are their bytes. Raises TypeSupportError."""
    if cls not in _carriers:
        _carriers[cls] = _make(cls)
    return _carriers[cls]


def _make(cls: type[Any]) -> type[Carrier]:
    package, folder, name = split(type_name(cls))
    description = Description(describe(cls))
    carrier: type[Carrier] = type(f"{name}Meta", (type,), {})(name, (Carrier,), {"__slots__": ()})
    _, capsules = native().message(
        carrier,
        f"{package}::{folder}",
        name,
        introspection_handle(description),
        *type_tables(cls, description),
        _data,
        carrier,
        _ANY_LAYOUT,
    )
    give(carrier, capsules)
    return carrier


def _data(message: Carrier) -> bytes:
    return message.data

"""The classes of rclpy's C extension that guards derive from, and as much of them as guards use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

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

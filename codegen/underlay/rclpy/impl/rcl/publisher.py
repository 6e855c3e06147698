"""The handle of a publisher."""

from __future__ import annotations

from functools import partial
from typing import Any

from rmw_local.graph import TypeConflictError
from rmw_local.message import message_type
from rmw_local.qos import unknown_policy

from .clock import rcl_duration_t
from .endpoint import EndpointHandle, resolve
from .errors import RCLError
from .qos import profile_of


class Publisher(EndpointHandle):
    """Publishes on one topic. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(self, node: object, pymsg_type: type[Any], topic: str, pyqos_profile: object) -> None:
        super().__init__()
        profile = profile_of(pyqos_profile)
        kind = message_type(pymsg_type)
        node, name = resolve(node, topic, "publisher")
        if policy := unknown_policy(profile):
            raise RCLError(f"Failed to create publisher: the {policy} policy is unknown")
        try:
            self._writer = writer = node.graph_node.create_writer(kind, name, profile)
        except TypeConflictError as error:
            raise RCLError(f"Failed to create publisher: create_publisher() called for {error}") from None
        self._attach(node, partial(node.graph_node.close_writer, writer))
        self._context = node.context
        self._publish = writer.publish

    @property
    def writer(self) -> Any:
        """The endpoint in the middleware, for the handles of events."""
        return self._writer

    def get_topic_name(self) -> str:
        """Return the topic's full name."""
        if self._destroyed:
            raise RCLError("failed to get publisher topic name: publisher pointer is invalid")
        return self._writer.topic

    def get_subscription_count(self) -> int:
        """Count the matched subscriptions."""
        self._bury()
        return len(self._writer.matches)

    def publish(self, pymsg: Any) -> None:
        """Deliver a message to every matched subscription."""
        if self._destroyed or not self._context.valid:
            self._refuse()
        self._publish(pymsg)

    def publish_raw(self, msg: bytes) -> None:
        """Deliver serialised bytes."""
        if not isinstance(msg, bytes):
            raise TypeError(f"publish_raw(msg: bytes): got {msg!r}")
        if self._destroyed or not self._context.valid:
            self._refuse()
        self._writer.publish_raw(msg)

    def publish_serialized(self, data: bytes) -> None:
        """Deliver a message of this type that rclpy itself has serialised."""
        if self._destroyed or not self._context.valid:
            self._refuse()
        self._writer.publish_bytes(data)

    def wait_for_all_acked(self, pytimeout: rcl_duration_t) -> bool:
        """Wait until reliable subscriptions in other processes have everything; those in this one have it."""
        return bool(self._writer.wait_until_received(pytimeout.nanoseconds))

    def assert_liveliness(self) -> None:
        """Say that the publisher lives, for one more lease."""
        if self._destroyed:
            raise RCLError("Failed to assert liveliness on the Publisher: publisher pointer is invalid")
        self._writer.assert_liveliness()

    def _refuse(self) -> None:
        why = "publisher pointer is invalid" if self._destroyed else "publisher's context is invalid"
        raise RCLError(f"Failed to publish: {why}")


def rclpy_assert_liveliness(publisher: Publisher) -> None:
    """Say that the publisher is alive."""
    publisher.assert_liveliness()

"""Publishers."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from rclpy.callback_groups import CallbackGroup
from rclpy.duration import Duration
from rclpy.event_handler import EventHandler, PublisherEventCallbacks
from rclpy.impl.blocking import Owned
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport
from rclpy.impl.typed import Generic, MessageT
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.impl.interface_protocols import MsgT as MsgT  # noqa: PLC0414 - programs import it from here
else:
    from rclpy.impl.typed import PlainBase

    __getattr__ = reexport(__name__)

MsgType = TypeVar("MsgType")  # programs import it from here


class _BasePublisher(Generic[MessageT]):
    """The common part of publishers of all kinds of nodes: `rclpy.publisher.BasePublisher`."""

    def __init__(
        self, publisher_impl: _rclpy.Publisher, msg_type: type[MessageT], topic: str, qos_profile: QoSProfile
    ) -> None:
        self.__publisher = publisher_impl
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile

    def publish(self, msg: MessageT | bytes) -> None:
        """Publish a message, or the CDR bytes of one.

        Raises TypeError for an object of another class, and SerializationError (a ValueError) for a field
        value that cannot be sent. For half of a surrogate pair it is a UnicodeEncodeError, too.
        """
        handle = self.__publisher
        if handle._destruction_requested:
            handle.refuse_if_destroyed()
        try:
            if isinstance(msg, self.msg_type):
                handle.publish(msg)
            elif isinstance(msg, bytes):
                handle.publish_raw(msg)
            else:
                raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        except _rclpy.RCLError:
            handle.refuse_if_destroyed()
            raise

    def get_subscription_count(self) -> int:
        """Return the number of matched subscriptions."""
        with self.handle:
            return self.__publisher.get_subscription_count()

    @property
    def topic_name(self) -> str:
        """The full topic name: expanded and remapped."""
        with self.handle:
            return self.__publisher.get_topic_name()

    @property
    def handle(self) -> _rclpy.Publisher:
        """The handle of the client library."""
        return self.__publisher

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        with self.handle:
            return self.__publisher.get_logger_name()

    def destroy(self) -> None:
        """Destroy it; to be called through `Node.destroy_publisher`."""
        self.__publisher.destroy_when_not_in_use()

    def assert_liveliness(self) -> None:
        """Say that this publisher lives; due once per lease where liveliness is manual by topic."""
        with self.handle:
            _rclpy.rclpy_assert_liveliness(self.handle)

    def wait_for_all_acked(self, timeout: Duration = Duration(seconds=-1)) -> bool:  # noqa: B008 - immutable
        """Wait until every matched reliable subscription has all messages; a negative timeout has no limit.

        Returns whether they have; at once True for a best effort publisher.
        """
        with self.handle:
            return self.__publisher.wait_for_all_acked(timeout._duration_handle)


if TYPE_CHECKING:
    _BaseOf = _BasePublisher
else:
    _BaseOf = PlainBase(_BasePublisher)


class Publisher(Owned, _BaseOf[MessageT]):
    """Publishes messages on a topic; made by `Node.create_publisher`."""

    _ros_entity = "Publisher"

    def __init__(
        self,
        publisher_impl: _rclpy.Publisher,
        msg_type: type[MessageT],
        topic: str,
        qos_profile: QoSProfile,
        event_callbacks: PublisherEventCallbacks,
        callback_group: CallbackGroup,
    ) -> None:
        super().__init__(publisher_impl, msg_type, topic, qos_profile)
        self.event_handlers: list[EventHandler] = event_callbacks.create_event_handlers(
            callback_group, publisher_impl, topic
        )

    def destroy(self) -> None:
        """Destroy it; to be called through `Node.destroy_publisher`."""
        for handler in self.event_handlers:
            handler.destroy()
        super().destroy()

"""Subscriptions."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeVar

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import EventHandler, SubscriptionEventCallbacks
from rclpy.impl.blocking import Owned
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport
from rclpy.impl.typed import Generic, MessageT
from rclpy.qos import QoSProfile
from rclpy.subscription_content_filter_options import ContentFilterOptions

if TYPE_CHECKING:
    from rclpy.impl.interface_protocols import MsgT as MsgT  # noqa: PLC0414 - programs import it from here
    from rclpy.impl.newer import MessageInfo as MessageInfo  # noqa: PLC0414 - programs import it from here
else:
    from rclpy.impl.typed import PlainBase

    __getattr__ = reexport(__name__)

MsgType = TypeVar("MsgType")  # programs import it from here


class _BaseSubscription(Generic[MessageT]):
    """The common part of subscriptions of all kinds of nodes: `rclpy.subscription.BaseSubscription`."""

    class CallbackType(Enum):
        """The arguments of a callback."""

        MessageOnly = 0
        WithMessageInfo = 1

    def __init__(
        self,
        subscription_impl: _rclpy.Subscription,
        msg_type: type[MessageT],
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile,
        raw: bool,
    ) -> None:
        self.__subscription = subscription_impl
        self.msg_type = msg_type
        self.topic = topic
        self.callback = callback
        self.qos_profile = qos_profile
        self.raw = raw

    def get_publisher_count(self) -> int:
        """Return the number of matched publishers."""
        with self.handle:
            return self.__subscription.get_publisher_count()

    @property
    def handle(self) -> _rclpy.Subscription:
        """The handle of the client library."""
        return self.__subscription

    @property
    def topic_name(self) -> str:
        """The full topic name: expanded and remapped."""
        with self.handle:
            return self.__subscription.get_topic_name()

    @property
    def callback(self) -> Callable[..., Any]:
        """The callback for each message, and for its metadata if it takes two arguments."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        self._callback = value
        if _takes(value, 1):
            self._callback_type = self.CallbackType.MessageOnly
        elif _takes(value, 2):
            self._callback_type = self.CallbackType.WithMessageInfo
        else:
            raise RuntimeError(
                "Subscription.__init__(): callback should be either be callable with one argument"
                "(to get only the message) or two (to get message and message info)"
            )

    @property
    def is_cft_enabled(self) -> bool:
        """Whether a content filter is active; InvalidHandle once it is destroyed."""
        with self.handle:
            return self.__subscription.is_cft_enabled()

    def set_content_filter(self, filter_expression: str, expression_parameters: list[str]) -> None:
        """Accept only messages for which an expression is true, from now on; an empty one accepts all.

        :param filter_expression: in the SQL subset of DDS.
        :param expression_parameters: the texts that `%0` to `%99` stand for.
        :raises RCLError: for a wrong expression; the filter stays as it was.
        :raises TypeError: if the parameters are no sequence of texts.
        """
        with self.handle:
            self.__subscription.set_content_filter(filter_expression, expression_parameters)

    def get_content_filter(self) -> ContentFilterOptions:
        """Return the filter; raises RCLError if there is none."""
        with self.handle:
            return ContentFilterOptions(*self.__subscription.get_content_filter())

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        with self.handle:
            return self.__subscription.get_logger_name()

    def destroy(self) -> None:
        """Destroy it; to be called through `Node.destroy_subscription`."""
        self.__subscription.destroy_when_not_in_use()


if TYPE_CHECKING:
    _BaseOf = _BaseSubscription
else:
    _BaseOf = PlainBase(_BaseSubscription)


class Subscription(Owned, _BaseOf[MessageT]):
    """Receives the messages of a topic; made by `Node.create_subscription`."""

    _ros_entity = "Subscription"

    def __init__(
        self,
        subscription_impl: _rclpy.Subscription,
        msg_type: type[MessageT],
        topic: str,
        callback: Callable[..., Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
        raw: bool,
        event_callbacks: SubscriptionEventCallbacks,
    ) -> None:
        super().__init__(subscription_impl, msg_type, topic, callback, qos_profile, raw)
        self.callback_group = callback_group
        # Set by an executor that has noticed the subscription and has yet to run the callback
        self._executor_event = False
        self.event_handlers: list[EventHandler] = event_callbacks.create_event_handlers(
            callback_group, subscription_impl, topic
        )

    def destroy(self) -> None:
        """Destroy it; to be called through `Node.destroy_subscription`."""
        for handler in self.event_handlers:
            handler.destroy()
        super().destroy()


def _takes(function: Callable[..., Any], count: int) -> bool:
    """Whether a function can be called with this many positional arguments."""
    try:
        inspect.signature(function).bind(*[None] * count)
    except TypeError:
        return False
    return True

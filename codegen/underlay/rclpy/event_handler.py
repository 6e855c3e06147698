"""QoS events: notifications of publishers and subscriptions about their counterparts."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.rcutils_logger import RcutilsLogger as _RcutilsLogger
from rclpy.logging import get_logger
from rclpy.qos import qos_policy_name_from_kind
from rclpy.waitable import NumberOfEntities, Waitable

QoSPublisherEventType = _rclpy.rcl_publisher_event_type_t
QoSSubscriptionEventType = _rclpy.rcl_subscription_event_type_t

# The arguments of the callbacks.
QoSRequestedDeadlineMissedInfo = _rclpy.rmw_requested_deadline_missed_status_t
QoSLivelinessChangedInfo = _rclpy.rmw_liveliness_changed_status_t
QoSMessageLostInfo = _rclpy.rmw_message_lost_status_t
QoSRequestedIncompatibleQoSInfo = _rclpy.rmw_requested_qos_incompatible_event_status_t
QoSSubscriptionMatchedInfo = _rclpy.rmw_matched_status_t
QoSOfferedDeadlineMissedInfo = _rclpy.rmw_offered_deadline_missed_status_t
QoSLivelinessLostInfo = _rclpy.rmw_liveliness_lost_status_t
QoSPublisherMatchedInfo = _rclpy.rmw_matched_status_t
QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo
IncompatibleTypeInfo = _rclpy.rmw_incompatible_type_status_t

UnsupportedEventTypeError = _rclpy.UnsupportedEventTypeError

_Callback = Callable[[Any], Any]


class EventHandler(Waitable):
    """Calls back when a status of a publisher or a subscription changed."""

    def __init__(
        self,
        *,
        callback_group: CallbackGroup,
        callback: _Callback,
        event_type: QoSPublisherEventType | QoSSubscriptionEventType,
        parent_impl: _rclpy.Publisher | _rclpy.Subscription,
    ) -> None:
        super().__init__(callback_group)
        self.event_type = event_type
        self.callback = callback
        with parent_impl:
            self.__event = _rclpy.EventHandle(parent_impl, event_type)
        self._fixed_handles = (self.__event,)
        self._ready_to_take_data = False
        self._event_index: int | None = None

    def is_ready(self, wait_set: _rclpy.WaitSet) -> bool:
        """Whether the wait set saw the event."""
        if self._event_index is None:
            return False
        if wait_set.is_ready("event", self._event_index):
            self._ready_to_take_data = True
        return self._ready_to_take_data

    def _find_ready(self) -> bool:
        """Look for a change of the status."""
        if self.__event.is_ready():
            self._ready_to_take_data = True
        return self._ready_to_take_data and not self.__event._destruction_requested

    def take_data(self) -> Any:
        """Take the status if the event was seen, else None."""
        if not self._ready_to_take_data:
            return None
        self._ready_to_take_data = False
        try:
            with self.__event:
                return self.__event.take_event()
        except InvalidHandle:  # destroyed since it was found ready
            return None

    async def execute(self, taken_data: Any) -> None:
        """Call back with a status."""
        if not taken_data:
            return
        from rclpy.executors import await_or_execute  # late: executors import nodes, nodes this

        await await_or_execute(self.callback, taken_data)

    def get_num_entities(self) -> NumberOfEntities:
        """Return what room it takes in a wait set: one event."""
        return NumberOfEntities(num_events=1)

    def add_to_wait_set(self, wait_set: _rclpy.WaitSet) -> None:
        """Add the event to a wait set."""
        with self.__event:
            self._event_index = wait_set.add_event(self.__event)

    def __enter__(self) -> None:
        self.__event.__enter__()

    def __exit__(
        self, t: type[BaseException] | None, v: BaseException | None, tb: TracebackType | None
    ) -> None:
        self.__event.__exit__(t, v, tb)

    def destroy(self) -> None:
        """Destroy it; done by its publisher or subscription."""
        self.__event.destroy_when_not_in_use()


class QoSEventHandler(EventHandler):
    """The former name of EventHandler."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        warnings.warn(
            "QoSEventHandler foo is deprecated, use EventHandler instead.", DeprecationWarning, stacklevel=2
        )
        super().__init_subclass__(**kwargs)

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        warnings.warn(
            "QoSEventHandler is deprecated, use EventHandler instead.", DeprecationWarning, stacklevel=2
        )
        super().__init__(*args, **kwargs)


def _create_handlers(
    callback_group: CallbackGroup,
    parent: _rclpy.Publisher | _rclpy.Subscription,
    callbacks: Sequence[tuple[QoSPublisherEventType | QoSSubscriptionEventType, _Callback | None]],
) -> list[EventHandler]:
    """Create a handler for each event that has a callback."""
    return [
        EventHandler(
            callback_group=callback_group, callback=callback, event_type=event_type, parent_impl=parent
        )
        for event_type, callback in callbacks
        if callback
    ]


def _warn_of_qos(logger: _RcutilsLogger, text: str) -> _Callback:
    """Make the callback that logs an incompatible counterpart where the user did not ask for the event."""

    def warn(event: Any) -> None:
        # Not `warning`, as upstream: tests put loggers of their own in place of rclpy's.
        logger.warn(text + qos_policy_name_from_kind(event.last_policy_kind))

    return warn


def _hear_of_type(_: Any) -> None:
    """Do nothing where the user did not ask for the event: the warning that caused it has said more."""


class SubscriptionEventCallbacks:
    """Callbacks for events of a subscription.

    Without a callback for incompatible QoS, `use_default_callbacks` logs a warning. For incompatible types,
    there is one anyway, with the reason.
    """

    def __init__(
        self,
        *,
        deadline: Callable[[QoSRequestedDeadlineMissedInfo], None] | None = None,
        incompatible_qos: Callable[[QoSRequestedIncompatibleQoSInfo], None] | None = None,
        liveliness: Callable[[QoSLivelinessChangedInfo], None] | None = None,
        message_lost: Callable[[QoSMessageLostInfo], None] | None = None,
        incompatible_type: Callable[[IncompatibleTypeInfo], None] | None = None,
        matched: Callable[[QoSSubscriptionMatchedInfo], None] | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline = deadline
        self.incompatible_qos = incompatible_qos
        self.liveliness = liveliness
        self.message_lost = message_lost
        self.incompatible_type = incompatible_type
        self.matched = matched
        self.use_default_callbacks = use_default_callbacks

    def create_event_handlers(
        self, callback_group: CallbackGroup, subscription: _rclpy.Subscription, topic_name: str
    ) -> list[EventHandler]:
        """Create the handlers of a subscription."""
        with subscription:
            logger = get_logger(subscription.get_logger_name())
        incompatible_qos, incompatible_type = self.incompatible_qos, self.incompatible_type
        if self.use_default_callbacks:
            incompatible_qos = incompatible_qos or _warn_of_qos(
                logger,
                f"New publisher discovered on topic '{topic_name}', offering incompatible QoS. "
                "No messages will be received from it. Last incompatible policy: ",
            )
            incompatible_type = incompatible_type or _hear_of_type
        event = QoSSubscriptionEventType
        return _create_handlers(
            callback_group,
            subscription,
            [
                (event.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED, self.deadline),
                (event.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS, incompatible_qos),
                (event.RCL_SUBSCRIPTION_LIVELINESS_CHANGED, self.liveliness),
                (event.RCL_SUBSCRIPTION_MESSAGE_LOST, self.message_lost),
                (event.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE, incompatible_type),
                (event.RCL_SUBSCRIPTION_MATCHED, self.matched),
            ],
        )


class PublisherEventCallbacks:
    """Callbacks for events of a publisher.

    Without a callback for incompatible QoS, `use_default_callbacks` logs a warning. For incompatible types,
    there is one anyway, with the reason.
    """

    def __init__(
        self,
        *,
        deadline: Callable[[QoSOfferedDeadlineMissedInfo], None] | None = None,
        liveliness: Callable[[QoSLivelinessLostInfo], None] | None = None,
        incompatible_qos: Callable[[QoSRequestedIncompatibleQoSInfo], None] | None = None,
        incompatible_type: Callable[[IncompatibleTypeInfo], None] | None = None,
        matched: Callable[[QoSPublisherMatchedInfo], None] | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline = deadline
        self.liveliness = liveliness
        self.incompatible_qos = incompatible_qos
        self.incompatible_type = incompatible_type
        self.matched = matched
        self.use_default_callbacks = use_default_callbacks

    def create_event_handlers(
        self, callback_group: CallbackGroup, publisher: _rclpy.Publisher, topic_name: str
    ) -> list[EventHandler]:
        """Create the handlers of a publisher."""
        with publisher:
            logger = get_logger(publisher.get_logger_name())
        incompatible_qos, incompatible_type = self.incompatible_qos, self.incompatible_type
        if self.use_default_callbacks:
            incompatible_qos = incompatible_qos or _warn_of_qos(
                logger,
                f"New subscription discovered on topic '{topic_name}', requesting incompatible QoS. "
                "No messages will be sent to it. Last incompatible policy: ",
            )
            incompatible_type = incompatible_type or _hear_of_type
        event = QoSPublisherEventType
        return _create_handlers(
            callback_group,
            publisher,
            [
                (event.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED, self.deadline),
                (event.RCL_PUBLISHER_LIVELINESS_LOST, self.liveliness),
                (event.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS, incompatible_qos),
                (event.RCL_PUBLISHER_INCOMPATIBLE_TYPE, incompatible_type),
                (event.RCL_PUBLISHER_MATCHED, self.matched),
            ],
        )

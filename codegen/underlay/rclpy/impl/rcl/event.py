"""The handle of a QoS event."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rmw_local.status import Status

from . import structs
from .endpoint import SourceHandle
from .publisher import Publisher
from .structs import rcl_publisher_event_type_t, rcl_subscription_event_type_t
from .subscription import Subscription

_PublisherEvent = rcl_publisher_event_type_t
_SubscriptionEvent = rcl_subscription_event_type_t


def _qos_status(total: int, change: int, kind: int) -> structs.rmw_requested_qos_incompatible_event_status_t:
    policy = structs.rmw_qos_policy_kind_t(kind or 1)
    return structs.rmw_requested_qos_incompatible_event_status_t(total, change, policy)


# How to find the status at the endpoint, and the struct that it is returned as.
_PUBLISHER_EVENTS: dict[_PublisherEvent, tuple[Callable[[Any], Any], Callable[..., Any]]] = {
    _PublisherEvent.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED: (
        lambda writer: writer.deadline or Status(),
        structs.rmw_offered_deadline_missed_status_t,
    ),
    _PublisherEvent.RCL_PUBLISHER_LIVELINESS_LOST: (
        lambda writer: writer.liveliness_lost,
        structs.rmw_liveliness_lost_status_t,
    ),
    _PublisherEvent.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS: (
        lambda writer: writer.incompatible_qos,
        _qos_status,
    ),
    _PublisherEvent.RCL_PUBLISHER_INCOMPATIBLE_TYPE: (
        lambda writer: writer.incompatible_type,
        structs.rmw_incompatible_type_status_t,
    ),
    _PublisherEvent.RCL_PUBLISHER_MATCHED: (lambda writer: writer.matched, structs.rmw_matched_status_t),
}
_SUBSCRIPTION_EVENTS: dict[_SubscriptionEvent, tuple[Callable[[Any], Any], Callable[..., Any]]] = {
    _SubscriptionEvent.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED: (
        lambda reader: reader.deadline or Status(),
        structs.rmw_requested_deadline_missed_status_t,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: (
        lambda reader: reader.liveliness_changed,
        structs.rmw_liveliness_changed_status_t,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS: (
        lambda reader: reader.incompatible_qos,
        _qos_status,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_MESSAGE_LOST: (
        lambda reader: reader.message_lost,
        structs.rmw_message_lost_status_t,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE: (
        lambda reader: reader.incompatible_type,
        structs.rmw_incompatible_type_status_t,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_MATCHED: (
        lambda reader: reader.matched,
        structs.rmw_matched_status_t,
    ),
}


class EventHandle(SourceHandle):
    """One kind of event of a publisher or a subscription; ready when its numbers changed."""

    def __init__(
        self,
        parent: Publisher | Subscription,
        event_type: rcl_publisher_event_type_t | rcl_subscription_event_type_t,
    ) -> None:
        super().__init__()
        if isinstance(parent, Publisher) and isinstance(event_type, _PublisherEvent):
            status_of, self._struct = _PUBLISHER_EVENTS[event_type]
            status = status_of(parent.writer)
        elif isinstance(parent, Subscription) and isinstance(event_type, _SubscriptionEvent):
            status_of, self._struct = _SUBSCRIPTION_EVENTS[event_type]
            status = status_of(parent.reader)
        else:
            raise TypeError(
                "EventHandle(): expected a subscription and an rcl_subscription_event_type_t, or a"
                f" publisher and an rcl_publisher_event_type_t, got {parent!r} and {event_type!r}"
            )
        self._use(status)
        self._take: Callable[[], tuple[int, ...]] = status.take
        self._parent = parent  # lives as long as its events

    def take_event(self) -> Any:
        """Return the current numbers and start counting changes again."""
        return self._struct(*self._take())

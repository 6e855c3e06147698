"""The handles of publishers, subscriptions and their QoS events, and messages as bytes."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

from rmw_local.graph import GraphNode
from rmw_local.message import DecodeError, MessageType, message_type
from rmw_local.status import Status

from rclpy.impl import distro

from . import structs
from .clock import rcl_duration_t
from .endpoint import EndpointHandle, SourceHandle
from .handle import RCLError, RMWError
from .qos import profile_of
from .structs import rcl_publisher_event_type_t, rcl_subscription_event_type_t

if TYPE_CHECKING:
    from rmw_local.content_filter import ContentFilter
    from rmw_local.mismatch.origin import Origin


CHECKS: Final = bool(os.environ.get("IFGEN_CHECK_FIELDS"))
"""Whether endpoints look at the ranges of fields; `ifgen_runtime.checks.ranges` has the details."""


def _look(endpoint: EndpointHandle, cls: type[Any], topic: str, verb: str) -> Callable[[Any], None] | None:
    """The function that looks at the messages of an endpoint, and warns in the name of its node."""
    from ifgen_runtime.checks.ranges import look_at  # late: few programs check

    from rclpy.logging import get_logger

    return look_at(cls, topic, verb, get_logger(endpoint.get_logger_name()).warning)


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


class Publisher(EndpointHandle):
    """Publishes on one topic. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(self, node: object, pymsg_type: type[Any], topic: str, pyqos_profile: object) -> None:
        super().__init__()
        profile, kind = profile_of(pyqos_profile), message_type(pymsg_type)
        self._writer = writer = self._open(
            "publisher",
            node,
            topic,
            profile,
            lambda place, name: place.create_writer(kind, name, profile),
            GraphNode.close_writer,
        )
        self._context = self._node.context
        self._publish = writer.publish
        if CHECKS and (look := _look(self, pymsg_type, writer.topic, "published")):

            def look_and_publish(message: Any) -> None:
                look(message)
                writer.publish(message)

            self._publish = look_and_publish

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
        self._close_pending()
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


MessageInfo = dict[str, Any]
# A message (or its bytes), its source stamp [ns, system time], its number among its publisher's messages, the
# stamp of its arrival [ns, system time], its publisher's gid.
Taken = tuple[Any, int, int, int, bytes]


class Subscription(SourceHandle, EndpointHandle):
    """Subscribes to one topic. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(
        self,
        node: object,
        pymsg_type: type[Any],
        topic: str,
        pyqos_profile: object,
        content_filter: tuple[str, Sequence[str]] | None = None,
    ) -> None:
        super().__init__()
        profile, kind = profile_of(pyqos_profile), message_type(pymsg_type)
        wanted = None
        if content_filter is not None:
            wanted = _compiled(kind, *content_filter, failure="Failed to create subscription")
        self._reader = reader = self._open(
            "subscription",
            node,
            topic,
            profile,
            lambda place, name: place.create_reader(kind, name, profile, wanted),
            GraphNode.close_reader,
        )
        self._use(reader)
        self._take = reader.take
        self._kind = kind
        self._deserialize = kind.deserialize
        self._drops = kind.drops
        self._look = _look(self, pymsg_type, reader.topic, "received") if CHECKS else None
        if self._look:
            self._deserialize = self._looking(kind.deserialize)

    @property
    def reader(self) -> Any:
        """The endpoint in the middleware, for the handles of events."""
        return self._reader

    def is_cft_enabled(self) -> bool:
        """Whether there is a content filter."""
        return self._reader.content_filter is not None

    def set_content_filter(self, filter_expression: str, expression_parameters: Sequence[str]) -> None:
        """Replace the content filter; an empty expression removes it. Raises RCLError for a wrong one."""
        failure = "Failed to set cft expression parameters"
        self._reader.set_filter(
            _compiled(self._kind, filter_expression, expression_parameters, failure=failure)
        )

    def get_content_filter(self) -> tuple[str, list[str]]:
        """Return expression and parameters; raises RCLError if there is none."""
        wanted = self._reader.content_filter
        if wanted is None:
            raise RCLError("Failed to get cft expression parameters: content filter is not set")
        return wanted.expression, list(wanted.parameters)

    def set_on_new_message_callback(self, callback: Callable[[int], object]) -> None:
        """Call back with the number of new messages, on the thread that brings them."""
        self._call_on_arrival(callback)

    def clear_on_new_message_callback(self) -> None:
        """End it."""
        self._call_on_arrival(None)

    def _count_waiting(self) -> int:
        return int(self._reader.unread)

    def use_views(self) -> None:
        """Leave sequences of numbers in the bytes that all subscriptions share, from now on."""
        self._reader.refuse_parcels()
        views = self._kind.deserialize_views
        self._deserialize = self._looking(views) if self._look else views

    def _looking(self, deserialize: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """The same, with a look at the ranges of each message."""

        def deserialize_and_look(data: Any) -> Any:
            message = deserialize(data)
            assert self._look is not None
            self._look(message)
            return message

        return deserialize_and_look

    def get_topic_name(self) -> str:
        """Return the topic's full name."""
        if self._destroyed:
            raise RCLError("failed to get subscription topic name: subscription pointer is invalid")
        return self._reader.topic

    def get_publisher_count(self) -> int:
        """Count the matched publishers."""
        self._close_pending()
        return self._reader.matched.current

    def take_message(self, pymsg_type: type[Any], raw: bool) -> tuple[Any, MessageInfo] | None:
        """Take the oldest message (`raw`: as bytes) and its metadata; None if none is there, or readable."""
        taken = self.take(raw)
        return None if taken is None else (taken[0], message_info(taken))

    def take(self, raw: bool) -> Taken | None:
        """Do what `take_message` does; the metadata are made by `message_info` when they are wanted."""
        if self._destroyed:
            raise RCLError("failed to take message from subscription: subscription pointer is invalid")
        sample: Any = self._take()
        if sample is None:
            return None
        if raw:
            return self._raw(sample)
        try:
            data, stamp, number, arrival, gid = sample
        except ValueError:  # it is marked
            return self._take_with_care(*sample)
        try:
            return self._deserialize(data), stamp, number, arrival, gid
        except DecodeError:
            self._drops.add()
            return None

    def _raw(self, sample: tuple[Any, ...]) -> Taken:
        """A message as bytes, as all that follow will be."""
        if self._reader.takes_parcels:
            self._reader.refuse_parcels()
        data, stamp, number, arrival, gid = sample[:5]
        return bytes(data), stamp, number, arrival, gid

    def _take_with_care(
        self, data: bytes, stamp: int, number: int, arrival: int, gid: bytes, origin: Origin
    ) -> Taken | None:
        """Read bytes that may be of another definition."""
        message = origin.read(data, self._kind, self._deserialize, self._reader.node)
        return None if message is None else (message, stamp, number, arrival, gid)


def _compiled(
    kind: MessageType, expression: str, parameters: Sequence[str], *, failure: str
) -> ContentFilter | None:
    """Compile a content filter; RCLError if it is wrong, TypeError if the parameters are no texts."""
    from rmw_local.content_filter import (
        MOST_PARAMETERS,
        FilterError,
        compile_filter,
    )  # late: few programs filter

    texts = list(parameters)
    if isinstance(parameters, str) or not all(isinstance(each, str) for each in texts):
        raise TypeError(f"the parameters of a content filter are a list of str, not {parameters!r}")
    if len(texts) > MOST_PARAMETERS:
        failure = "Failed to set content_filter_options"
    try:
        return compile_filter(kind.cls, expression, texts)
    except FilterError as error:
        raise RCLError(f"{failure}: {error}") from None


def message_info(taken: Taken) -> MessageInfo:
    """The metadata of a message."""
    _, stamp, number, arrival, gid = taken
    info: MessageInfo = {
        "source_timestamp": stamp,
        "received_timestamp": arrival,  # in one process, delivery happens inside publish
        "publication_sequence_number": number,
        "reception_sequence_number": None,
    }
    if distro.follows("publisher_gid"):
        info["publisher_gid"] = {"implementation_identifier": "rmw_local", "data": gid}
    return info


_PublisherEvent = rcl_publisher_event_type_t
_SubscriptionEvent = rcl_subscription_event_type_t


def _qos_status(total: int, change: int, kind: int) -> structs.rmw_requested_qos_incompatible_event_status_t:
    policy = structs.rmw_qos_policy_kind_t(kind or 1)
    return structs.rmw_requested_qos_incompatible_event_status_t(total, change, policy)


# The name of the status at the endpoint, and the struct that it is returned as.
_PUBLISHER_EVENTS: dict[_PublisherEvent, tuple[str, Callable[..., Any]]] = {
    _PublisherEvent.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED: (
        "deadline",
        structs.rmw_offered_deadline_missed_status_t,
    ),
    _PublisherEvent.RCL_PUBLISHER_LIVELINESS_LOST: ("liveliness_lost", structs.rmw_liveliness_lost_status_t),
    _PublisherEvent.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS: ("incompatible_qos", _qos_status),
    _PublisherEvent.RCL_PUBLISHER_INCOMPATIBLE_TYPE: (
        "incompatible_type",
        structs.rmw_incompatible_type_status_t,
    ),
    _PublisherEvent.RCL_PUBLISHER_MATCHED: ("matched", structs.rmw_matched_status_t),
}
_SUBSCRIPTION_EVENTS: dict[_SubscriptionEvent, tuple[str, Callable[..., Any]]] = {
    _SubscriptionEvent.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED: (
        "deadline",
        structs.rmw_requested_deadline_missed_status_t,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: (
        "liveliness_changed",
        structs.rmw_liveliness_changed_status_t,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS: ("incompatible_qos", _qos_status),
    _SubscriptionEvent.RCL_SUBSCRIPTION_MESSAGE_LOST: ("message_lost", structs.rmw_message_lost_status_t),
    _SubscriptionEvent.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE: (
        "incompatible_type",
        structs.rmw_incompatible_type_status_t,
    ),
    _SubscriptionEvent.RCL_SUBSCRIPTION_MATCHED: ("matched", structs.rmw_matched_status_t),
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
            name, self._struct = _PUBLISHER_EVENTS[event_type]
            status = getattr(parent.writer, name)
        elif isinstance(parent, Subscription) and isinstance(event_type, _SubscriptionEvent):
            name, self._struct = _SUBSCRIPTION_EVENTS[event_type]
            status = getattr(parent.reader, name)
        else:
            raise TypeError(
                "EventHandle(): expected a subscription and an rcl_subscription_event_type_t, or a"
                f" publisher and an rcl_publisher_event_type_t, got {parent!r} and {event_type!r}"
            )
        status = status or Status()  # an endpoint without a deadline misses none
        self._use(status)
        self._take: Callable[[], tuple[int, ...]] = status.take
        self._parent = parent  # lives as long as its events

    def take_event(self) -> Any:
        """Return the current numbers and start counting changes again."""
        return self._struct(*self._take())

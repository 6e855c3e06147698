"""The handle of a subscription."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from rmw_local.graph import TypeConflictError
from rmw_local.message import DecodeError, message_type
from rmw_local.qos import unknown_policy

from .endpoint import EndpointHandle, SourceHandle, resolve
from .errors import RCLError
from .qos import profile_of

if TYPE_CHECKING:
    from rmw_local.mismatch.origin import Origin

MessageInfo = dict[str, int | None]
# A message (or its bytes), its source stamp [ns, system time], its number among its publisher's messages, the
# stamp of its arrival [ns, system time].
Taken = tuple[Any, int, int, int]


class Subscription(SourceHandle, EndpointHandle):
    """Subscribes to one topic. Raises ValueError for a bad name, RCLError for anything else that is wrong."""

    def __init__(self, node: object, pymsg_type: type[Any], topic: str, pyqos_profile: object) -> None:
        super().__init__()
        profile = profile_of(pyqos_profile)
        kind = message_type(pymsg_type)
        node, name = resolve(node, topic, "subscription")
        if policy := unknown_policy(profile):
            raise RCLError(f"Failed to create subscription: the {policy} policy is unknown")
        try:
            self._reader = reader = node.graph_node.create_reader(kind, name, profile)
        except TypeConflictError as error:
            raise RCLError(
                f"Failed to create subscription: create_subscription() called for {error}"
            ) from None
        self._attach(node, partial(node.graph_node.close_reader, reader))
        self._use(reader)
        self._take = reader.take
        self._kind = kind
        self._deserialize = kind.deserialize
        self._drops = kind.drops

    @property
    def reader(self) -> Any:
        """The endpoint in the middleware, for the handles of events."""
        return self._reader

    def use_views(self) -> None:
        """Leave sequences of numbers in the bytes that all subscriptions share, from now on."""
        self._reader.refuse_parcels()
        self._deserialize = self._kind.deserialize_views

    def get_topic_name(self) -> str:
        """Return the topic's full name."""
        if self._destroyed:
            raise RCLError("failed to get subscription topic name: subscription pointer is invalid")
        return self._reader.topic

    def get_publisher_count(self) -> int:
        """Count the matched publishers."""
        self._bury()
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
            data, stamp, number, arrival = sample
        except ValueError:  # it is marked
            return self._take_with_care(*sample)
        try:
            return self._deserialize(data), stamp, number, arrival
        except DecodeError:
            self._drops.add()
            return None

    def _raw(self, sample: tuple[Any, ...]) -> Taken:
        """A message as bytes, as all that follow will be."""
        if self._reader.takes_parcels:
            self._reader.refuse_parcels()
        data, stamp, number, arrival = sample[:4]
        return bytes(data), stamp, number, arrival

    def _take_with_care(
        self, data: bytes, stamp: int, number: int, arrival: int, origin: Origin
    ) -> Taken | None:
        """Read bytes that may be of another definition."""
        message = origin.read(data, self._kind, self._deserialize, self._reader.node)
        return None if message is None else (message, stamp, number, arrival)


def message_info(taken: Taken) -> MessageInfo:
    """The metadata of a message."""
    _, stamp, number, arrival = taken
    return {
        "source_timestamp": stamp,
        "received_timestamp": arrival,  # in one process, delivery happens inside publish
        "publication_sequence_number": number,
        "reception_sequence_number": None,
    }

"""The publishing end of a topic: delivers to every matched reader, on the caller's thread."""

from __future__ import annotations

import itertools
import threading
from collections import deque
from typing import TYPE_CHECKING, Any

from rmw_local import observer, timing
from rmw_local.endpoint import Endpoint
from rmw_local.liveliness import Liveliness
from rmw_local.qos import INFINITE, MANUAL_BY_TOPIC
from rmw_local.status import DeadlineStatus

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.qos import QosProfile
    from rmw_local.reader import Reader, Sample


class Writer(Endpoint):
    """A volatile writer: it keeps nothing, so publishing needs no lock.

    `_direct` and `_by_bytes` are replaced, never changed; a message that is being published while a
    reader joins or leaves may reach it or not, as on any network.
    """

    def __init__(self, node: GraphNode, message_type: MessageType, topic: str, qos: QosProfile) -> None:
        super().__init__(node, message_type, topic, qos)
        self.deadline = DeadlineStatus(qos.deadline) if qos.deadline < INFINITE else None
        self.liveliness = Liveliness(
            manual=qos.liveliness == MANUAL_BY_TOPIC, lease=qos.liveliness_lease_duration
        )
        self._timed = self.deadline is not None or qos.liveliness == MANUAL_BY_TOPIC
        self._direct: tuple[Reader, ...] = ()  # readers of our very class: they get copies
        self._by_bytes: tuple[Reader, ...] = ()  # readers with another class for the same type
        self._numbers = itertools.count(1)
        self._copy = message_type.copy
        self._observer = observer.current()

    @property
    def readers(self) -> tuple[Reader, ...]:
        """The matched readers."""
        return self._direct + self._by_bytes

    def publish(self, message: Any) -> None:
        """Deliver a message of the writer's class; its fields are checked as serialising would check them."""
        stamp = timing.time_ns()
        number = next(self._numbers)
        copy = self._copy
        if self._timed:
            self._note_publication()
        for reader in self._direct:
            reader.accept((copy(message), stamp, stamp, number))
        if self._by_bytes or not self._direct:
            self._publish_indirectly(message, stamp, number)

    def publish_bytes(self, data: bytes) -> None:
        """Deliver a serialised message as it is; readers find out whether it makes sense."""
        stamp = timing.time_ns()
        sample = (data, stamp, stamp, next(self._numbers))
        if self._timed:
            self._note_publication()
        for reader in self.readers:
            reader.accept(sample)
        self._note_nobody()

    def assert_liveliness(self) -> None:
        """Say that the writer lives, for one more lease."""
        self.liveliness.assert_alive()

    def connect(self, reader: Reader) -> None:
        """Deliver to one more reader. Called with the domain's lock held."""
        if reader.message_type.cls is self.message_type.cls:
            self._direct = (*self._direct, reader)
        else:
            self._by_bytes = (*self._by_bytes, reader)

    def disconnect(self, reader: Reader) -> None:
        """Deliver to a reader no longer. Called with the domain's lock held."""
        self._direct = tuple(known for known in self._direct if known is not reader)
        self._by_bytes = tuple(known for known in self._by_bytes if known is not reader)

    def _publish_indirectly(self, message: Any, stamp: int, number: int) -> None:
        """Deliver by bytes; without any reader, still refuse what could not be sent."""
        if not self._by_bytes:
            self._copy(message)
            self._note_nobody()
            return
        data = self.message_type.serialize(message)
        for reader in self._by_bytes:
            reader.accept((data, stamp, stamp, number))

    def _note_nobody(self) -> None:
        if self._observer is not None and not self.readers:
            self._observer.undelivered(self.topic, 1, "published while no subscription was matched")

    def _note_publication(self) -> None:
        if self.deadline is not None:
            self.deadline.touch()
        self.liveliness.assert_alive()


class DurableWriter(Writer):
    """A transient local writer: it keeps its history for readers that come later.

    Its lock makes "store, then deliver" and "replay, then join" exclude each other: a late joiner misses
    nothing and gets nothing twice. Lock order: the domain's lock before it.
    """

    def __init__(self, node: GraphNode, message_type: MessageType, topic: str, qos: QosProfile) -> None:
        super().__init__(node, message_type, topic, qos)
        self._lock = threading.Lock()
        self._history: deque[Sample] = deque(maxlen=qos.queue_length)

    def publish(self, message: Any) -> None:
        """Keep a copy and deliver."""
        self._publish(self._copy(message))

    def publish_bytes(self, data: bytes) -> None:
        """Keep and deliver serialised bytes."""
        self._publish(data)

    def _publish(self, payload: Any) -> None:
        if self._timed:
            self._note_publication()
        with self._lock:
            stamp = timing.time_ns()
            sample: Sample = (payload, stamp, stamp, next(self._numbers))
            self._history.append(sample)
            readers = self.readers
            for reader in readers:
                reader.store(self._sample_for(reader, sample))
        for reader in readers:
            reader.notify()

    def connect(self, reader: Reader) -> None:
        """Replay what is kept to a transient local reader, then deliver to it as well."""
        with self._lock:
            if reader.qos.durability == self.qos.durability:
                born_after = timing.time_ns() - self.qos.lifespan
                for sample in self._history:
                    if sample[1] > born_after:
                        reader.store(self._sample_for(reader, sample))
            super().connect(reader)

    def _sample_for(self, reader: Reader, sample: Sample) -> Sample:
        """Give each reader an object of its own."""
        payload, source_stamp, received_stamp, number = sample
        if isinstance(payload, bytes):
            return sample
        same = reader.message_type.cls is self.message_type.cls
        own = self._copy(payload) if same else self.message_type.serialize(payload)
        return own, source_stamp, received_stamp, number

"""The publishing end of a topic: delivers to every matched reader, on the caller's thread."""

from __future__ import annotations

import itertools
import threading
from collections import deque
from typing import TYPE_CHECKING, Any, Protocol

from rmw_local import observer, timing
from rmw_local.mismatch.passage import Marking
from rmw_local.qos import INFINITE, MANUAL_BY_TOPIC, RELIABLE
from rmw_local.status import DeadlineStatus, Lease, LivelinessLostStatus
from rmw_local.topic import Endpoint

if TYPE_CHECKING:
    from collections.abc import Callable

    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.mismatch.origin import Origin
    from rmw_local.qos import QosProfile
    from rmw_local.reader import Reader, Sample


class RemoteSink(Protocol):
    """All readers of one writer that are in other processes: they get what it publishes, sent once."""

    def accept(self, sample: Sample) -> None:
        """Send a message."""

    def store(self, sample: Sample) -> None:
        """Send a message, as far as the writer's lock is concerned."""

    def announce(self) -> None:
        """Follow a `store`, when the caller holds no lock any more."""

    def assert_alive(self) -> None:
        """Say that the writer is alive."""

    def wait_until_received(self, writer: Writer, patience: int) -> bool:
        """Wait until reliable readers have everything, for `patience` [ns]; returns whether they have."""


class Writer(Endpoint):
    """A volatile writer: it keeps nothing, so publishing needs no lock.

    `readers` is replaced, never changed; a message that is being published while a reader joins or leaves may
    reach it or not, as on any network. Some of them are stand-ins (`rmw_local.mismatch.passage`). Readers in
    other processes, of which there may be tens of thousands, come and go in constant time.
    """

    role = "publisher"
    _keeps = False  # whether readers that come later get what is published now

    def __init__(self, node: GraphNode, message_type: MessageType, topic: str, qos: QosProfile) -> None:
        super().__init__(node, message_type, topic, qos)
        self.readers: tuple[Reader | Marking | RemoteSink, ...] = ()  # what messages are delivered to
        # The matched readers of this process (replaced, never changed), and those elsewhere with the last
        # message that each does not get.
        self.local_readers: tuple[Reader, ...] = ()
        self.remote_readers: dict[Reader, int] = {}
        self.remote_sink: RemoteSink | None = None  # the way to other processes, while there are any
        # Whether somebody there listens, announced or not, as tools do that know keys only
        self.is_heard = False
        self._marking: dict[Reader, Marking] = {}  # the stand-ins; replaced, never changed
        self._own_origin: Origin | None = None  # once it publishes bytes
        self.deadline = DeadlineStatus(qos.deadline) if qos.deadline < INFINITE else None
        self._manual = qos.liveliness == MANUAL_BY_TOPIC
        self.liveliness_lost = LivelinessLostStatus(qos.liveliness_lease_duration, manual=self._manual)
        self._leases: dict[Reader, Lease] = {}  # of local readers that want to know; replaced, never changed
        self._timed = self.deadline is not None or self._manual
        self._numbers = itertools.count(1)
        self.last_number = 0  # of what it has published
        # How to serialise for these readers: one thing, so that no other reader gets what was made for one.
        self._route: tuple[Callable[[Any], Any], tuple[Reader | Marking | RemoteSink, ...]]
        self._route = (message_type.serialize, ())
        self._observer = observer.current()

    @property
    def matches(self) -> list[Reader]:
        """The matched readers now: those in other processes, too, which share the sink."""
        return [*self.local_readers, *self.remote_readers]

    def publish(self, message: Any) -> None:
        """Deliver a message of the writer's class; refuses field values that cannot be sent, read or not."""
        serialize, readers = self._route
        self._deliver(serialize(message), readers)

    def publish_bytes(self, data: bytes) -> None:
        """Deliver a serialised message of the writer's class."""
        self._deliver(data, self.readers)

    def _deliver(self, data: Any, readers: tuple[Reader | Marking | RemoteSink, ...]) -> None:
        if self._timed:
            self._note_publication()
        now = timing.time_ns()
        self.last_number = number = next(self._numbers)
        sample = (data, now, number, now, self.gid)
        for reader in readers:
            reader.accept(sample)
        if self._observer is not None and not readers:
            self._observer.undelivered(self.topic, 1, "published while no subscription was matched")

    def publish_raw(self, data: bytes) -> None:
        """Deliver bytes of unknown contents; from now on readers look what is in those of this writer."""
        if self._own_origin is None:
            self._doubt()
        self.publish_bytes(data)

    def assert_liveliness(self) -> None:
        """Say that the writer lives, for one more lease."""
        if self._manual:
            self.sign_leases()
            if self.remote_sink is not None:
                self.remote_sink.assert_alive()

    def wait_until_received(self, patience: int) -> bool:
        """Wait until reliable readers have everything, for `patience` [ns]; returns whether they have.

        Those in this process have everything when publishing returns.
        """
        if self.remote_sink is None or self.qos.reliability != RELIABLE:
            return True
        return self.remote_sink.wait_until_received(self, patience)

    def sign_leases(self) -> None:
        """Note a sign of life."""
        for lease in (self.liveliness_lost.lease, *self._leases.values()):
            lease.sign()

    def connect(self, reader: Reader, origin: Origin | None = None) -> None:
        """Deliver to one more reader, marked with an origin. Called with the domain's lock held."""
        if reader.is_remote:
            self.remote_readers[reader] = self._last_before(reader)
            if len(self.remote_readers) == 1:
                self.settle_route()
            return
        patience = reader.qos.liveliness_lease_duration
        if patience < INFINITE:
            lease = Lease(reader.liveliness_changed, patience, manual=self._manual)
            if self._manual:  # others never lapse
                reader.liveliness_changed.watch(lease)
            self._leases = {**self._leases, reader: lease}
        self.receiver(reader, origin)
        self.local_readers = (*self.local_readers, reader)
        self.settle_route()

    def attach(self, sink: RemoteSink | None) -> None:
        """Deliver to other processes by this sink from now on. Called with the domain's lock held."""
        self.remote_sink = sink
        for reader in self.remote_readers:
            self.remote_readers[reader] = self._last_before(reader)
        self.settle_route()

    def detach_in_fork(self) -> None:
        """Deliver to other processes no longer, whoever held a lock when the process was forked."""
        self.remote_sink = None
        self.settle_route()

    def _last_before(self, reader: Reader) -> int:
        """The number of the last message that is not for a reader elsewhere."""
        return self.last_number

    def receiver(self, reader: Reader, origin: Origin | None = None) -> Reader | Marking:
        """The reader, or what stands for it."""
        known = self._marking.get(reader)
        origin = origin or self._own_origin
        if known is None and origin is not None:
            known = Marking(reader, origin)
            self._marking = {**self._marking, reader: known}
        return known or reader

    def reaches(self, reader: Reader) -> bool:
        """Whether it delivers to a reader."""
        return reader in (self.remote_readers if reader.is_remote else self.local_readers)

    def disconnect(self, reader: Reader) -> None:
        """Deliver to a reader no longer. Called with the domain's lock held."""
        if reader.is_remote:
            del self.remote_readers[reader]
            if not self.remote_readers:
                self.settle_route()
            return
        self.local_readers = tuple(known for known in self.local_readers if known is not reader)
        self.settle_route()
        if reader in self._marking:
            self._marking = {each: known for each, known in self._marking.items() if each is not reader}
        lease = self._leases.get(reader)
        if lease is not None:
            self._leases = {known: each for known, each in self._leases.items() if known is not reader}
            reader.liveliness_changed.forget(lease)
            lease.end()

    def settle_route(self) -> None:
        """Choose how to serialise for the readers that there are now. Called with the domain's lock held."""
        local = tuple(map(self.receiver, self.local_readers))
        kind = self.message_type
        serialize = kind.serialize
        is_wanted = self._keeps or self.is_heard or self.remote_readers
        if self.remote_sink is not None and is_wanted:
            self.readers = (*local, self.remote_sink)
        else:
            self.readers = local
            if len(local) == 1 and not self._keeps:
                (reader,) = local
                if not isinstance(reader, Marking) and reader.takes_parcels and reader.message_type is kind:
                    serialize = kind.pack
        self._route = serialize, self.readers

    def _doubt(self) -> None:
        """Mark all messages, to readers that there are and to those to come."""
        from rmw_local.mismatch.origin import Origin  # late: few programs publish bytes

        with self.node.participant.domain.lock:
            if self._own_origin is None:
                self._own_origin = Origin("topic", self.topic, self.node, is_raw=True)
                self.settle_route()

    def _note_publication(self) -> None:
        if self.deadline is not None:
            self.deadline.touch()
        self.assert_liveliness()


class DurableWriter(Writer):
    """A transient local writer: it keeps its history for readers that come later.

    Its lock makes "store, then deliver" and "replay, then join" exclude each other: a late joiner misses
    nothing and gets nothing twice. Lock order: the domain's lock before it.
    """

    _keeps = True

    def __init__(self, node: GraphNode, message_type: MessageType, topic: str, qos: QosProfile) -> None:
        super().__init__(node, message_type, topic, qos)
        self._lock = threading.Lock()
        self._history: deque[Sample] = deque(maxlen=qos.queue_length)

    def _deliver(self, data: Any, readers: tuple[Reader | Marking | RemoteSink, ...]) -> None:
        """Keep and deliver, to whoever is there once the lock is held."""
        if self._timed:
            self._note_publication()
        with self._lock:
            now = timing.time_ns()
            self.last_number = number = next(self._numbers)
            sample = (data, now, number, now, self.gid)
            self._history.append(sample)
            readers = self.readers
            for reader in readers:
                reader.store(sample)
        for reader in readers:
            reader.announce()

    def connect(self, reader: Reader, origin: Origin | None = None) -> None:
        """Replay what is kept to a transient local reader, then deliver to it as well."""
        with self._lock:
            if reader.qos.durability == self.qos.durability and not reader.is_remote:
                self._replay(self.receiver(reader, origin))
            super().connect(reader, origin)

    def attach(self, sink: RemoteSink | None) -> None:
        """Give the sink what is kept: it replays that to transient local readers in other processes."""
        with self._lock:
            if sink is not None:
                self._replay(sink)
            super().attach(sink)

    def detach_in_fork(self) -> None:
        """Deliver to other processes no longer."""
        self._lock = threading.Lock()
        super().detach_in_fork()

    def _last_before(self, reader: Reader) -> int:
        """Readers that are durable get what is kept."""
        is_owed = self._history and reader.qos.durability == self.qos.durability
        return self._history[0][2] - 1 if is_owed else self.last_number

    def _replay(self, reader: Reader | Marking | RemoteSink) -> None:
        born_after = timing.time_ns() - self.qos.lifespan
        for sample in self._history:
            if sample[1] > born_after:
                reader.store(sample)

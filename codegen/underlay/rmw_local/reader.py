"""The subscribing end of a topic: a queue that publishers fill."""

from __future__ import annotations

import sys
from collections import deque
from typing import TYPE_CHECKING, Any, Final

from rmw_local import observer, timing
from rmw_local.message import DecodeError
from rmw_local.notices import say
from rmw_local.qos import INFINITE
from rmw_local.ready import ReadySource
from rmw_local.status import DeadlineStatus, LivelinessChangedStatus, Status
from rmw_local.topic import Endpoint

if TYPE_CHECKING:
    from rmw_local.content_filter import ContentFilter
    from rmw_local.graph import GraphNode
    from rmw_local.message import MessageType
    from rmw_local.mismatch.origin import Origin
    from rmw_local.qos import QosProfile

_MARKED: Final = 6  # the parts of a message with an origin
_MUCH: Final = 5000
"""The number of messages that Fast DDS keeps for a subscription that keeps all."""

# One message on its way: (CDR bytes, source stamp [ns, system time], number among its publisher's messages,
# stamp of its arrival [ns, system time], its publisher's gid). All readers share it. Bytes rather than
# objects: an unread message is never decoded, and every reader gets its own object when it takes the message.
# Bytes that may be of another definition have an Origin as well. A reader that is alone may get a parcel in
# place of the bytes (`MessageType.pack`).
Sample = tuple[Any, int, int, int, bytes] | tuple[bytes, int, int, int, bytes, "Origin"]


class _Closed(deque[Sample]):
    """Looks empty, and keeps elsewhere what is appended: no check is needed where messages come and go."""

    def __init__(self, held: deque[Sample]) -> None:
        super().__init__()
        self.held = held

    def append(self, sample: Sample) -> None:
        self.held.append(sample)


class Reader(ReadySource, Endpoint):
    """A reader of one topic. Filling and emptying the queue takes no lock: a bounded deque is atomic."""

    role = "subscription"
    stands_in = False  # whether it is another one again, in another process, for a definition that it adapts
    overwritten = 0
    """The number of messages that newer ones replaced while it was measured."""
    _is_measured = False
    content_filter: ContentFilter | None = None
    """Which messages it wants; None: all. `set_filter` changes it."""
    filter_elsewhere: tuple[str, tuple[str, ...]] | None = None
    """Expression and parameters of the filter that it has in another process."""

    def __init__(self, node: GraphNode, message_type: MessageType, topic: str, qos: QosProfile) -> None:
        ReadySource.__init__(self)
        Endpoint.__init__(self, node, message_type, topic, qos)
        self._queue: deque[Sample] = deque(maxlen=qos.queue_length)
        self.takes_parcels = True
        self.liveliness_changed = LivelinessChangedStatus()
        self.message_lost = Status()  # on the way from other processes
        self.deadline = DeadlineStatus(qos.deadline) if qos.deadline < INFINITE else None
        self._observer = observer.current()
        self.measure(is_wanted=False)

    def measure(self, is_wanted: bool) -> None:
        """Count what is overwritten from now on, or no longer."""
        self._is_measured = is_wanted
        self._is_watched = is_wanted or self._observer is not None
        self._plain = self.deadline is None and not self._is_watched and self.content_filter is None

    def set_filter(self, content_filter: ContentFilter | None) -> None:
        """Queue only what this accepts, from now on."""
        if content_filter is not None and self.takes_parcels:
            self.takes_parcels = False
            self.refuse_parcels()
        self.content_filter = content_filter
        self.measure(self._is_measured)
        link = self.node.participant.domain.link
        if link is not None:
            link.show_anew(self)

    def _is_wanted(self, sample: Sample) -> bool:
        """Whether the filter accepts a message. What cannot be read is dropped where it is taken."""
        kind, content_filter = self.message_type, self.content_filter
        try:
            if len(sample) == _MARKED:
                message = sample[5].read(sample[0], kind, kind.deserialize, self.node)
            else:
                message = kind.deserialize(sample[0])
        except DecodeError:
            return True
        return content_filter is None or (message is not None and content_filter.accepts(message))

    def is_ready(self) -> bool:
        """Whether a message waits."""
        return bool(self._queue)

    def accept(self, sample: Sample) -> None:
        """Queue a message and notify the listeners. The caller holds no lock."""
        if self._plain:
            self._queue.append(sample)
            for listener in self._listeners:
                listener()
        elif self.content_filter is None or self._is_wanted(sample):
            self.store(sample)
            self.announce()

    def store(self, sample: Sample) -> None:
        """Queue a message; `announce` has to follow when the caller holds no lock any more."""
        if self.content_filter is not None and not self._is_wanted(sample):
            return
        if self._is_watched and self.unread == self.qos.queue_length:
            self._note_overwriting()
        self._queue.append(sample)

    def _note_overwriting(self) -> None:
        if self._observer is not None:
            self._observer.undelivered(self.topic, 1, "overwritten before it was read")
        if self._is_measured:
            self.overwritten += 1

    def announce(self) -> None:
        """Notify the listeners that wait for messages."""
        if self.deadline is not None:
            self.deadline.touch()
        self.notify()

    def refuse_parcels(self) -> None:
        """Get bytes from now on, except for messages that wait already. The caller holds no lock."""
        domain = self.node.participant.domain
        with domain.lock:
            self.takes_parcels = False
            topic = domain.topics.get(self.topic)
            for writer in topic.writers if topic else ():
                writer.settle_route()

    def take(self) -> Sample | None:
        """Remove and return the oldest message, None if there is none."""
        try:
            return self._queue.popleft()
        except IndexError:
            return None

    @property
    def unread(self) -> int:
        """The number of waiting messages."""
        queue = self._queue
        return len(queue.held if isinstance(queue, _Closed) else queue)

    @property
    def end(self) -> Reader:
        """Itself: what stands for a reader has it there."""
        return self

    def withhold(self) -> None:
        """Be empty from now on, whatever comes. Called with the domain's lock held, as is `release`."""
        if not isinstance(self._queue, _Closed):
            self._queue = _Closed(self._queue)

    def release(self) -> None:
        """Have what was withheld: as many messages as ever wait, the newest ones."""
        if isinstance(self._queue, _Closed):
            self._queue = self._queue.held


class LifespanReader(Reader):
    """A reader whose messages grow too old to be read."""

    def is_ready(self) -> bool:
        """Whether a message waits that is still young enough."""
        self._drop_expired()
        return bool(self._queue)

    def take(self) -> Sample | None:
        """Remove and return the oldest message that is still young enough."""
        self._drop_expired()
        return super().take()

    def _drop_expired(self) -> None:
        born_after = timing.time_ns() - self.qos.lifespan
        try:
            while self._queue[0][1] <= born_after:
                self._queue.popleft()
        except IndexError:
            return


class UnboundedReader(Reader):
    """A reader that keeps all: it says once when very much waits."""

    _much = _MUCH

    def accept(self, sample: Sample) -> None:
        """Queue a message and notify the listeners. The caller holds no lock."""
        super().accept(sample)
        if len(self._queue) > self._much:
            self._say_so()

    def announce(self) -> None:
        """Notify the listeners that wait for messages."""
        super().announce()
        if len(self._queue) > self._much:
            self._say_so()

    def _say_so(self) -> None:
        self._much = sys.maxsize
        say(
            f"more than {_MUCH} messages wait for a subscription of {self.node.full_name} to '{self.topic}', "
            "which keeps all: their memory grows without end, where Fast DDS would drop what comes now. Spin "
            "the node more often, or use KEEP_LAST with a depth"
        )


class UnboundedLifespanReader(UnboundedReader, LifespanReader):
    """Both of these."""

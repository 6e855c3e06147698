"""Endpoints of a lockstep run: what they send waits for the end of the round, also within a process.

So it does not matter which nodes share one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rmw_local import timing
from rmw_local.writer import DurableWriter, Writer

if TYPE_CHECKING:
    from rmw_local.lockstep.side import Side
    from rmw_local.mismatch.passage import Marking
    from rmw_local.reader import Reader, Sample
    from rmw_local.service import Letter, ServiceEndpoint
    from rmw_local.writer import RemoteSink


class HeldWriter(Writer):
    """A writer whose messages reach those who are there when the round ends."""

    _last: tuple[Reader | Marking | RemoteSink, ...] = ()  # whom it left with messages on their way

    def settle_route(self) -> None:
        """Serialise always. Other processes get everything, apart from these readers."""
        self.readers = tuple(map(self.receiver, self.local_readers))
        self._route = self.message_type.serialize, self.readers

    def disconnect(self, reader: Reader) -> None:
        """Deliver to a reader no longer, except what is on its way if it is the writer that leaves."""
        if self.closed and not reader.is_remote:
            self._last = (*self._last, self.receiver(reader))
        super().disconnect(reader)

    def _deliver(self, data: Any, readers: tuple[Reader | Marking | RemoteSink, ...]) -> None:
        if self._timed:
            self._note_publication()
        now = timing.time_ns()
        sample = (data, now, next(self._numbers), now, self.gid)
        _side(self).hold(self.node.full_name, self._arrive, sample)
        if self.remote_sink is not None:
            self.remote_sink.accept(sample)

    def _arrive(self, sample: Sample) -> None:
        readers = (*self.readers, *self._last)
        for reader in readers:
            reader.accept(sample)
        if self._observer is not None and not readers and not self.matches:
            self._observer.undelivered(self.topic, 1, "published while no subscription was matched")


class HeldDurableWriter(HeldWriter, DurableWriter):
    """A transient local writer of the kind. What it keeps reaches a late joiner when the round ends, too."""

    def _arrive(self, sample: Sample) -> None:
        with self._lock:
            self._history.append(sample)
        super()._arrive(sample)

    def _replay(self, reader: Reader | Marking | RemoteSink) -> None:
        if reader is not self.remote_sink:
            for sample in self._history:
                if sample[1] > timing.time_ns() - self.qos.lifespan:
                    _side(self).hold(self.node.full_name, reader.accept, sample, is_early=True)


class HeldEnd:
    """Stands for a server or a client of the same process."""

    is_remote = False

    def __init__(self, side: Side, sender: ServiceEndpoint, end: Any) -> None:
        self.end: ServiceEndpoint = end.end
        self._hold = side.hold
        self._sender = sender.node.full_name
        self._accept = end.accept

    def accept(self, letter: Letter) -> None:
        """Keep a request or a response until the round ends."""
        self._hold(self._sender, self._accept, letter)


def _side(writer: Writer) -> Side:
    side = writer.node.participant.side
    assert side is not None
    return side

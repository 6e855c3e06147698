"""Messages of another definition from other processes, for a subscription whose node adapts them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rmw_local import timing
from rmw_local.mismatch.passage import Marking
from rmw_local.reader import Reader
from rmw_local.transports.remote import RemoteWriter

if TYPE_CHECKING:
    from rmw_local.mismatch.encounter import Encounter
    from rmw_local.transports.others import Others


class Adapted:
    """Delivers what is addressed to one other definition. It is a `rmw_local.transports.seam.OnSample`."""

    def __init__(self, others: Others, encounter: Encounter) -> None:
        """`encounter` is the first one with a publisher of that definition."""
        assert isinstance(encounter.mine, Reader) and encounter.origin is not None
        self.reader = encounter.mine
        self.type_hash = encounter.theirs.kind.type_hash
        self._others = others
        # Messages may be faster than what announces their publisher. They count as those of the first one.
        self._unknown = Marking(self.reader, encounter.origin)

    def __call__(self, data: bytes, number: int, stamp: int, gid: bytes) -> None:
        """Deliver a message."""
        now = timing.time_ns()
        end = self._unknown
        writer = self._others.get(gid)
        if isinstance(writer, RemoteWriter):
            marked = writer.receiver(self.reader)
            is_theirs = writer.kind.type_hash == self.type_hash and writer.reaches(self.reader)
            if not (is_theirs and isinstance(marked, Marking)):
                return  # not matched
            writer.note_arrival(self.reader, number)
            if stamp <= now - writer.qos.lifespan:
                return  # too old
            writer.note_life()
            end = marked
        end.accept((data, stamp, number, now))

"""Whether a writer is alive: always (automatic), or for one lease after it last said so (manual by topic)."""

from __future__ import annotations

import threading

from rmw_local import timing
from rmw_local.ready import ReadySource
from rmw_local.status import LivelinessChangedStatus, LivelinessLostStatus

_NEW, _ALIVE, _LOST = range(3)


class Liveliness:
    """The state of one writer; it tells the writer's own status and those of the matched readers.

    Lock order: its lock before a status's.
    """

    def __init__(self, *, manual: bool, lease: int) -> None:
        self._lock = threading.Lock()
        self._manual = manual
        self._lease = lease  # [ns]
        self._state = _NEW if manual else _ALIVE
        self._asserted_at = 0  # [ns], steady
        self._readers: tuple[LivelinessChangedStatus, ...] = ()
        self.lost = LivelinessLostStatus(self)

    def assert_alive(self) -> None:
        """Note that the writer published, or said that it lives."""
        if not self._manual:
            return
        self.catch_up()
        with self._lock:
            self._asserted_at = timing.monotonic_ns()
            if self._state == _ALIVE:
                return
            for reader in self._readers:
                reader.add(1, -1 if self._state == _LOST else 0)
            self._state = _ALIVE
            changed: tuple[ReadySource, ...] = (self.lost, *self._readers)
        for source in changed:
            source.notify()

    def catch_up(self) -> None:
        """Notice that the lease has ended."""
        with self._lock:
            at = self.lapses_at()
            if at is None or timing.monotonic_ns() < at:
                return
            self._state = _LOST
            self.lost.add()
            for reader in self._readers:
                reader.add(-1, 1)
            changed: tuple[ReadySource, ...] = (self.lost, *self._readers)
        for source in changed:
            source.notify()

    def lapses_at(self) -> int | None:
        """When the lease ends [ns, steady] if nothing is heard; None if it cannot."""
        return self._asserted_at + self._lease if self._manual and self._state == _ALIVE else None

    def join(self, reader: LivelinessChangedStatus) -> None:
        """Report to one more reader."""
        with self._lock:
            self._readers = (*self._readers, reader)
            reader.watch(self)
            if self._state == _ALIVE:
                reader.add(1, 0)

    def leave(self, reader: LivelinessChangedStatus) -> None:
        """Stop reporting to a reader; it counts this writer no longer."""
        with self._lock:
            if reader not in self._readers:
                return
            self._readers = tuple(known for known in self._readers if known is not reader)
            reader.forget(self)
            if self._state != _NEW:
                reader.add(-1 if self._state == _ALIVE else 0, -1 if self._state == _LOST else 0)

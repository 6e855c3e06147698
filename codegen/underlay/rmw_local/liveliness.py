"""Whether a writer is alive: always (automatic), or for a while after it last said so (manual by topic)."""

from __future__ import annotations

import threading
from typing import Protocol

from rmw_local import timing

_NEW, _ALIVE, _LOST = range(3)


class LivelinessStatus(Protocol):
    """A counter of changes of leases. All methods except `notify` are called with the lease's lock held."""

    def revived(self, *, was_lost: bool) -> None:
        """Count a writer that is alive now: for the first time, or again."""

    def lapsed(self) -> None:
        """Count a writer that is no longer alive."""

    def ended(self, *, alive: bool) -> None:
        """Count a writer, alive or lapsed, that is no longer matched."""

    def notify(self) -> None:
        """Notify the listeners."""


class Lease:
    """A writer as one party sees it: the writer itself, or a matched reader, each with its own lease.

    Lock order: its lock before the status's.
    """

    def __init__(self, status: LivelinessStatus, duration: int, *, manual: bool) -> None:
        self._lock = threading.Lock()
        self._status = status
        self._duration = duration  # [ns]
        self._manual = manual
        self._signed_at = 0  # [ns], steady
        self._state = _NEW
        if not manual:
            self._state = _ALIVE
            status.revived(was_lost=False)

    def sign(self) -> None:
        """Note that the writer published, or said that it lives."""
        with self._lock:
            self._lapse()
            self._signed_at = timing.monotonic_ns()
            if self._state == _ALIVE:
                return
            self._status.revived(was_lost=self._state == _LOST)
            self._state = _ALIVE
        self._status.notify()

    def catch_up(self) -> None:
        """Notice that the lease has run out."""
        with self._lock:
            lapsed = self._lapse()
        if lapsed:
            self._status.notify()

    def ends_at(self) -> int | None:
        """The end of the lease without a sign of life [ns, steady]; None if it has no end."""
        return self._signed_at + self._duration if self._manual and self._state == _ALIVE else None

    def end(self) -> None:
        """Note that the writer or the reader goes."""
        with self._lock:
            if self._state != _NEW:
                self._status.ended(alive=self._state == _ALIVE)
            self._state = _NEW

    def _lapse(self) -> bool:
        at = self.ends_at()
        if at is None or timing.monotonic_ns() < at:
            return False
        self._state = _LOST
        self._status.lapsed()
        return True

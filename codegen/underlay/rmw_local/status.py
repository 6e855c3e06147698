"""The counters of an endpoint for its QoS events: matches, incompatibilities, missed deadlines, liveliness.

A status is a `ReadySource`: ready if something changed since it was last taken. `take()` returns the numbers
in the order of rmw's struct and resets the changes. Timed statuses need no thread: they catch up when asked,
and `wake_at` is the next time to ask.
"""

from __future__ import annotations

import threading
from typing import Protocol

from rmw_local import timing
from rmw_local.ready import ReadySource

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


class Status(ReadySource):
    """A total and its change since the last take."""

    __slots__ = ("_lock", "change", "changed", "total")

    def __init__(self) -> None:
        super().__init__()
        self._lock = threading.Lock()  # innermost: nothing else is acquired under it
        self.total = 0
        self.change = 0
        self.changed = False

    def is_ready(self) -> bool:
        """Whether something changed since the last take."""
        return self.changed

    def add(self, count: int = 1) -> None:
        """Count; the caller notifies when it holds no lock."""
        with self._lock:
            self.total += count
            self.change += count
            self.changed = True

    def take(self) -> tuple[int, ...]:
        """Return (total_count, total_count_change)."""
        with self._lock:
            numbers = (self.total, self.change)
            self.change = 0
            self.changed = False
        return numbers


class IncompatibleTypeStatus(Status):
    """Counterparts of another type; rmw passes on the change only."""

    __slots__ = ()

    def take(self) -> tuple[int, ...]:
        """Return (total_count_change,)."""
        return super().take()[1:]


class IncompatibleQosStatus(Status):
    """Counterparts that asked for, or offered, too little."""

    __slots__ = ("last_policy_kind",)

    def __init__(self) -> None:
        super().__init__()
        self.last_policy_kind = 0

    def refuse(self, policy_kind: int) -> None:
        """Count one incompatible counterpart."""
        self.last_policy_kind = policy_kind
        self.add()

    def take(self) -> tuple[int, ...]:
        """Return (total_count, total_count_change, last_policy_kind)."""
        return (*super().take(), self.last_policy_kind)


class MatchedStatus(Status):
    """Counterparts that came and went."""

    __slots__ = ("current", "current_change")

    def __init__(self) -> None:
        super().__init__()
        self.current = 0
        self.current_change = 0

    def joined(self) -> None:
        """Count one counterpart that came."""
        self.add()
        with self._lock:
            self.current += 1
            self.current_change += 1

    def left(self) -> None:
        """Count one counterpart that went."""
        with self._lock:
            self.current -= 1
            self.current_change -= 1
            self.changed = True

    def take(self) -> tuple[int, ...]:
        """Return (total_count, total_count_change, current_count, current_count_change)."""
        numbers = super().take()
        with self._lock:
            current = (self.current, self.current_change)
            self.current_change = 0
        return numbers + current


class DeadlineStatus(Status):
    """Periods without a message, counted from the first message on."""

    __slots__ = ("_due", "_period")

    def __init__(self, period: int) -> None:
        super().__init__()
        self._period = period  # [ns]
        self._due: int | None = None  # [ns], steady; None: no message yet

    def touch(self) -> None:
        """Note a message: the current period starts again."""
        now = timing.monotonic_ns()
        with self._lock:
            first = self._due is None
            self._catch_up(now)
            self._due = now + self._period
        if first:  # later ones only move the end of the period away, which sleepers need not know
            self.notify()

    def is_ready(self) -> bool:
        """Whether a deadline was missed since the last take."""
        with self._lock:
            self._catch_up(timing.monotonic_ns())
            return self.changed

    def take(self) -> tuple[int, ...]:
        """Return (total_count, total_count_change) as of now."""
        self.is_ready()
        return super().take()

    def wake_at(self) -> int | None:
        """The end of the present period [ns, steady]."""
        return self._due

    def _catch_up(self, now: int) -> None:
        if self._due is None or now < self._due:
            return
        missed = (now - self._due) // self._period + 1
        self._due += missed * self._period
        self.total += missed
        self.change += missed
        self.changed = True


class LivelinessLostStatus(Status):
    """The number of times that a writer failed to say in time that it is alive."""

    __slots__ = ("lease",)

    def __init__(self, duration: int, *, manual: bool) -> None:
        super().__init__()
        self.lease = Lease(self, duration, manual=manual)

    def revived(self, *, was_lost: bool) -> None:
        """Do nothing: only losses count here."""

    def lapsed(self) -> None:
        """Count a loss."""
        self.add()

    def ended(self, *, alive: bool) -> None:
        """Do nothing: a writer does not part from itself."""

    def is_ready(self) -> bool:
        """Whether liveliness was lost since the last take."""
        self.lease.catch_up()
        return self.changed

    def take(self) -> tuple[int, ...]:
        """Return (total_count, total_count_change) as of now."""
        self.lease.catch_up()
        return super().take()

    def wake_at(self) -> int | None:
        """The end of the lease [ns, steady]."""
        return self.lease.ends_at()


class LivelinessChangedStatus(ReadySource):
    """The number of a reader's matched writers that are alive, and of those that stopped being alive."""

    __slots__ = ("_leases", "_lock", "alive", "alive_change", "changed", "not_alive", "not_alive_change")

    def __init__(self) -> None:
        super().__init__()
        self._lock = threading.Lock()
        self._leases: dict[Lease, None] = {}  # of writers that may fall silent
        self.alive = self.alive_change = self.not_alive = self.not_alive_change = 0
        self.changed = False

    def watch(self, lease: Lease) -> None:
        """Follow a matched writer."""
        self._leases[lease] = None

    def forget(self, lease: Lease) -> None:
        """Stop following a writer that went."""
        self._leases.pop(lease, None)

    def revived(self, *, was_lost: bool) -> None:
        """Count a writer that is alive now, and take back its loss."""
        self._add(1, -1 if was_lost else 0)

    def lapsed(self) -> None:
        """Count a writer that is no longer alive."""
        self._add(-1, 1)

    def ended(self, *, alive: bool) -> None:
        """Take back the count of a writer that is no longer matched."""
        self._add(-1 if alive else 0, 0 if alive else -1)

    def is_ready(self) -> bool:
        """Whether a writer's state changed since the last take."""
        self._catch_up()
        return self.changed

    def wake_at(self) -> int | None:
        """The end of the first lease [ns, steady]."""
        return min((at for lease in list(self._leases) if (at := lease.ends_at()) is not None), default=None)

    def take(self) -> tuple[int, ...]:
        """Return (alive_count, not_alive_count, alive_count_change, not_alive_count_change) as of now."""
        self._catch_up()
        with self._lock:
            numbers = (self.alive, self.not_alive, self.alive_change, self.not_alive_change)
            self.alive_change = self.not_alive_change = 0
            self.changed = False
        return numbers

    def _catch_up(self) -> None:
        for lease in list(self._leases):
            lease.catch_up()

    def _add(self, alive: int, not_alive: int) -> None:
        with self._lock:
            self.alive += alive
            self.alive_change += alive
            self.not_alive += not_alive
            self.not_alive_change += not_alive
            self.changed = True

"""Virtual time that several processes share: it passes when none of them has anything more to do."""

from __future__ import annotations

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from rmw_local.lockstep.errors import RunHasEnded
from rmw_local.virtual_time import VirtualDriver, driven_by

if TYPE_CHECKING:
    from rmw_local.lockstep.side import Side
    from rmw_local.virtual_time import Member

_PATIENCE: Final = 100_000  # readings: how often a process looks must not depend on who else is in it


class LockstepDriver(VirtualDriver):
    """The driver of one process; the thread that makes it, the main thread, has the first turn."""

    patience = _PATIENCE

    def __init__(self, side: Side, seed: int = 0) -> None:
        super().__init__(seed)
        self.side = self._side = side
        self._interrupts = False  # the main thread, when it is its turn
        assert self._running is not None
        self._main = self._running

    def _let_time_pass(self, deadline: int | None) -> bool:
        side = self._side
        was_over, keeps = side.is_over, side.keeps_something
        self._now = max(self._now, side.exchange(deadline, self._now))
        if side.failure:
            return False
        if not side.is_over or (was_over and keeps):
            return True
        if not was_over:
            self._interrupts = True
            return True
        return super()._let_time_pass(deadline)

    def _can_run(self, member: Member) -> bool:
        return (self._interrupts and member is self._main) or super()._can_run(member)

    def _stuck(self) -> Member | None:
        if not self._side.failure or not self._members:
            return super()._stuck()
        first = min(self._members.values(), key=lambda member: member.number)
        first.error = RunHasEnded(self._side.failure)
        return first

    def _await_turn(self, me: Member) -> None:
        super()._await_turn(me)
        if self._interrupts and threading.current_thread() is threading.main_thread():
            self._interrupts = False
            signal.raise_signal(signal.SIGINT)


@contextmanager
def lockstep_time(side: Side, seed: int) -> Generator[LockstepDriver]:
    """Run the block as one process of a lockstep run."""
    with driven_by(LockstepDriver(side, seed)) as driver:
        yield driver

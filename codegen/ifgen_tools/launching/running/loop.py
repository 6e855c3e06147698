"""The thread that runs a launch: calls that others post, and calls for which the time has come."""

from __future__ import annotations

import heapq
import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue

Call = Callable[[], None]
_STEP = 0.2  # [s] on some systems a waiting thread does not notice a signal


@dataclass(order=True)
class TimedCall:
    """A call at a time [s] of the monotonic clock."""

    due: float
    number: int
    call: Call | None = field(compare=False)
    until_shutdown: bool = field(compare=False)

    def cancel(self) -> None:
        """Do not make it."""
        self.call = None


class Loop:
    """Makes calls one after the other. `post` may come from any thread and from signal handlers."""

    def __init__(self) -> None:
        self._posted: SimpleQueue[Call] = SimpleQueue()
        self._timed: list[TimedCall] = []
        self._numbers = itertools.count()

    def post(self, call: Call) -> None:
        """Make a call after those that wait."""
        self._posted.put(call)

    def later(self, seconds: float, call: Call, *, until_shutdown: bool) -> TimedCall:
        """Make a call when so much time has passed."""
        timed = TimedCall(time.monotonic() + seconds, next(self._numbers), call, until_shutdown)
        heapq.heappush(self._timed, timed)
        return timed

    def cancel_until_shutdown(self) -> None:
        """Cancel the timed calls that end with a shutdown."""
        for timed in self._timed:
            if timed.until_shutdown:
                timed.cancel()

    def has_work(self) -> bool:
        """Return whether there are calls to make, now or later."""
        return not self._posted.empty() or any(timed.call is not None for timed in self._timed)

    def step(self) -> None:
        """Make the next call, or wait for one for a moment."""
        while self._timed and (self._timed[0].call is None or self._timed[0].due <= time.monotonic()):
            call = heapq.heappop(self._timed).call
            if call is not None:
                call()
                return
        wait = self._timed[0].due - time.monotonic() if self._timed else _STEP
        try:
            call = self._posted.get(timeout=max(0.0, min(wait, _STEP)))
        except Empty:
            return
        call()

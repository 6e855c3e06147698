"""Makes the standard library wait in virtual time: threads, locks and what is made of them, `time`.

Objects made inside the block work together with the scheduler. Modules that took `sleep` or `Lock` by `from
... import` before keep the real ones. asyncio works as well, except for Windows' proactor.
"""

from __future__ import annotations

import _thread
import concurrent.futures.thread  # noqa: F401 - makes locks when it is imported: before they are exchanged
import queue
import selectors
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from types import TracebackType
from typing import Any

from rmw_local import timing
from rmw_local.timing import Waker
from rmw_local.virtual_time import PolledWaker, VirtualDriver


class Lock:
    """The replacement of `threading.Lock`; waiting for it hands over to another thread.

    Stays with its driver.
    """

    def __init__(self, driver: VirtualDriver) -> None:
        self._driver = driver
        self._inner = _thread.allocate_lock()
        self._waiting: deque[Waker] = deque()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Take it."""
        if self._inner.acquire(blocking=False):
            return True
        if not blocking or timeout == 0:
            return False
        until = None if timeout < 0 else self._driver.monotonic_ns() + int(timeout * 1e9)
        waker = self._driver.waker()
        self._waiting.append(waker)
        try:
            while not self._inner.acquire(blocking=False):
                if not self._driver.wait(waker, until):
                    return self._inner.acquire(blocking=False)
            return True
        finally:
            self._waiting.remove(waker)

    def release(self) -> None:
        """Free it."""
        self._inner.release()
        for waker in list(self._waiting):
            waker.wake()

    def locked(self) -> bool:
        """Whether somebody has it."""
        return self._inner.locked()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self._inner = _thread.allocate_lock()
        self._waiting.clear()


class Selector(selectors.DefaultSelector):
    """The waiting primitive of asyncio's loops, each of which works like a thread.

    Sockets and pipes know nothing of this time. A loop that waits for them, and for no time, really waits.
    """

    driver: VirtualDriver

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Wait for events as `selectors` does, in virtual time."""
        found = super().select(0)
        if found or (timeout is not None and timeout <= 0):
            return found
        # One of them is what the loop's own threads wake it with.
        if timeout is None and len(self.get_map()) > 1:
            return super().select()
        until = None if timeout is None else self.driver.monotonic_ns() + int(timeout * 1e9) + 1
        poll = super().select
        self.driver.wait(PolledWaker(self.driver, lambda: bool(poll(0))), until)
        return poll(0)


class _Started:
    """The event "this thread has begun".

    The wait is real, because the start of a thread needs nobody's turn.
    """

    def __init__(self) -> None:
        self._begun = False
        self._gate = _thread.allocate_lock()
        self._gate.acquire()

    def is_set(self) -> bool:
        return self._begun

    def set(self) -> None:
        self._begun = True
        self._gate.release()

    def wait(self, timeout: float | None = None) -> bool:
        with self._gate:
            return True


@contextmanager
def cooperative_threading(driver: VirtualDriver) -> Iterator[None]:
    """Let the standard library's waiting go through this driver."""
    ends: dict[threading.Thread, timing.Event] = {}
    real_start, real_join = threading.Thread.start, threading.Thread.join

    def start(thread: threading.Thread) -> None:
        me = driver.announce(thread)
        run: Callable[[], Any] = thread.run
        ended = ends[thread] = timing.Event()

        def run_in_turn() -> None:
            driver.enter(me)
            try:
                run()
            finally:
                ended.set()
                driver.leave()

        thread.run = run_in_turn  # type: ignore[method-assign]
        thread._started = _Started()  # type: ignore[attr-defined]
        real_start(thread)

    def join(thread: threading.Thread, timeout: float | None = None) -> None:
        ended = ends.get(thread)
        if ended is None or ended.wait(timeout):
            real_join(thread, timeout)

    exchanged: list[tuple[Any, str, Any]] = [
        (threading.Thread, "start", start),
        (threading.Thread, "join", join),
        (threading, "Lock", partial(Lock, driver)),
        (threading, "_allocate_lock", partial(Lock, driver)),
        (threading, "RLock", threading._PyRLock),  # type: ignore[attr-defined]  # the one that is made of Locks
        (threading, "_time", lambda: driver.monotonic_ns() / 1e9),
        (queue, "time", lambda: driver.monotonic_ns() / 1e9),
        (selectors, "DefaultSelector", type("DefaultSelector", (Selector,), {"driver": driver})),
        (queue, "SimpleQueue", queue._PySimpleQueue),  # type: ignore[attr-defined]  # made of a semaphore
        (time, "sleep", timing.sleep),
        (time, "time", lambda: driver.time_ns() / 1e9),
        (time, "time_ns", driver.time_ns),
        (time, "monotonic", lambda: driver.monotonic_ns() / 1e9),
        (time, "monotonic_ns", driver.monotonic_ns),
    ]
    real = [(owner, name, getattr(owner, name)) for owner, name, _ in exchanged]
    try:
        for owner, name, new in exchanged:
            setattr(owner, name, new)
        yield
    finally:
        for owner, name, old in real:
            setattr(owner, name, old)

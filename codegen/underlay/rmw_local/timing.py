"""The one place where the tree asks for the time, sleeps or blocks.

Everything goes through the current driver: system time by default, or a virtual one
(`rmw_local.virtual_time`) that is put in place with `install`. Call the functions through the module
(`timing.monotonic_ns()`): `install` exchanges them.
"""

from __future__ import annotations

import _thread
import os
import select
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from math import inf
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rmw_local.lockstep.side import Side

_END_OF_SELECTABLE = 1024  # FD_SETSIZE


class Waker:
    """One sleeper's alarm: `wake` ends the wait that is going on, or the next one if none is.

    It is a bare lock, because a signal handler may wake the very thread that it interrupts: a lock-protected
    flag could be held by that thread.
    """

    __slots__ = ("_asleep",)

    def __init__(self) -> None:
        self._asleep = _thread.allocate_lock()  # not threading's, which virtual time exchanges
        self._asleep.acquire()

    def wake(self) -> None:
        """Wake the sleeper; any thread, any number of times."""
        try:  # noqa: SIM105 - a context manager would take longer than all the rest
            self._asleep.release()
        except RuntimeError:
            pass  # it has been woken already and did not yet notice

    def sleep(self, timeout: float) -> bool:
        """Sleep for real, at most `timeout` seconds (-1: no limit); True if woken."""
        return self._asleep.acquire(timeout=timeout) if timeout else self._asleep.acquire(blocking=False)


class HandOverWaker(Waker):
    """A waker that lets go of the interpreter while it wakes, so that the sleeper can go on at once.

    A thread that a lock wakes takes the place of the waking thread, finds that that holds the interpreter,
    and waits again: that was a quarter of the cost of a message to another thread. Uses a file descriptor, so
    it is for threads that sleep repeatedly. Raises OSError if there are none, or none left.
    """

    __slots__ = ("_descriptor",)

    def __init__(self) -> None:
        super().__init__()
        self._descriptor = -1
        if not hasattr(os, "eventfd"):
            raise OSError("this system has no eventfd")
        self._descriptor = os.eventfd(0)
        if self._descriptor >= _END_OF_SELECTABLE:
            raise OSError("the file descriptor is too large for select")

    def __del__(self) -> None:
        if self._descriptor >= 0:
            os.close(self._descriptor)

    def wake(self) -> None:
        """Wake the sleeper."""
        os.eventfd_write(self._descriptor, 1)

    def sleep(self, timeout: float) -> bool:
        """Sleep until woken (True), or for `timeout` [s] (False; below 0: no end)."""
        if timeout >= 0 and not select.select((self._descriptor,), (), (), timeout)[0]:
            return False
        os.read(self._descriptor, 8)  # unlike os.eventfd_read, it goes on after a signal
        return True


class Driver(Protocol):
    """The source of time, and the way in which a thread waits.

    Steady times are ns since an arbitrary start. `side` is this process's side of a lockstep run, if there is
    one.
    """

    side: Side | None

    def time_ns(self) -> int:
        """The system time [ns since 1970]."""
        ...

    def monotonic_ns(self) -> int:
        """The steady time [ns]."""
        ...

    def waker(self, *, lasting: bool = False) -> Waker:
        """Make an alarm for one sleeper; `lasting`: for one that sleeps again and again."""
        ...

    def wait(self, waker: Waker, until: int | None) -> bool:
        """Block this thread until it is woken (True) or it is `until` [ns, steady] (False; None: no end)."""
        ...


# A lock cannot, or should not, wait longer than this [s]; longer waits go in several steps.
_LONGEST_SLEEP = min(threading.TIMEOUT_MAX, 1e6)
# The same for the main thread, which must hear Ctrl-C. On Windows a thread that waits for a lock hears none.
# Elsewhere, Python notes a signal that comes just before a wait, and then waits: also for long, if other
# threads keep the interpreter busy at that moment.
_LONGEST_OF_MAIN = 0.1 if sys.platform == "win32" else 0.5


class SystemDriver:
    """Time of the operating system."""

    side: Side | None = None
    time_ns = staticmethod(time.time_ns)
    monotonic_ns = staticmethod(time.monotonic_ns)

    def waker(self, *, lasting: bool = False) -> Waker:
        """Make an alarm; a lasting one with an eventfd, if there is one."""
        if lasting:
            with suppress(OSError):
                return HandOverWaker()
        return Waker()

    def wait(self, waker: Waker, until: int | None) -> bool:
        """Block this thread until it is woken (True), or until the steady time (False; None: no end)."""
        is_main = _thread.get_ident() == threading.main_thread().ident
        longest = _LONGEST_OF_MAIN if is_main else _LONGEST_SLEEP
        while until is not None or is_main:
            left = inf if until is None else (until - self.monotonic_ns()) / 1e9
            if left <= longest:
                return waker.sleep(max(left, 0.0))
            if waker.sleep(longest):
                return True
        return waker.sleep(-1)


SYSTEM: Driver = SystemDriver()
driver: Driver = SYSTEM
time_ns: Callable[[], int] = SYSTEM.time_ns
monotonic_ns: Callable[[], int] = SYSTEM.monotonic_ns
make_waker: Callable[..., Waker] = SYSTEM.waker
wait: Callable[[Waker, int | None], bool] = SYSTEM.wait


def install(new: Driver) -> Driver:
    """Let everything run on this driver from now on; returns the one before.

    Nothing may be waiting meanwhile.
    """
    global driver, time_ns, monotonic_ns, make_waker, wait
    old, driver = driver, new
    time_ns, monotonic_ns, make_waker, wait = new.time_ns, new.monotonic_ns, new.waker, new.wait
    return old


def deadline(timeout: float | None) -> int | None:
    """The steady time [ns] in `timeout` seconds; None (no limit) for None, negative or infinite."""
    if timeout is None or timeout < 0 or timeout == float("inf"):
        return None
    return monotonic_ns() + int(timeout * 1e9)


def sleep(seconds: float) -> None:
    """The equivalent of `time.sleep`."""
    wait(make_waker(), monotonic_ns() + int(max(seconds, 0) * 1e9))


class Event:
    """The equivalent of `threading.Event`: set once or many times, with any number of waiting threads."""

    def __init__(self) -> None:
        self._set = False
        self._sleepers: tuple[Waker, ...] = ()
        self._lock = _thread.RLock()  # reentrant: a signal handler may set it while this thread is inside

    def is_set(self) -> bool:
        """Whether it is set."""
        return self._set

    def set(self) -> None:
        """Set it and wake all waiting threads."""
        with self._lock:
            self._set = True
            sleepers = self._sleepers
        for sleeper in sleepers:
            sleeper.wake()

    def clear(self) -> None:
        """Unset it."""
        self._set = False

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until it is set, at most `timeout` seconds; returns whether it was."""
        return self.wait_until(deadline(timeout))

    def wait_until(self, until: int | None) -> bool:
        """Wait until it is set, or until a steady time [ns]; returns whether it was set."""
        if self._set:
            return True
        sleeper = make_waker()
        with self._lock:
            self._sleepers = (*self._sleepers, sleeper)
        try:
            while not self._set:
                if not wait(sleeper, until):
                    return self._set
            return True
        finally:
            with self._lock:
                self._sleepers = tuple(known for known in self._sleepers if known is not sleeper)

"""Virtual time with a deterministic scheduler: an hour's waiting takes milliseconds and repeats exactly.

    with virtual_time(seed=1):
        ...  # make contexts, nodes, executors and threads inside; time.sleep and threading work as usual

One thread runs at a time. It hands over when it blocks. A seeded choice picks the next among those that can
go on. If none can, the clock jumps to the earliest deadline. The same seed leads to the same order. Computing
takes no time. Each of asyncio's loops works like a thread.
"""

from __future__ import annotations

import _thread
import random
import threading
import weakref
from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from rmw_local import timing
from rmw_local.timing import Waker

if TYPE_CHECKING:
    from rmw_local.lockstep.side import Side

START = 1_700_000_000 * 10**9  # [ns since 1970] what the system clock shows first
_READING_TAKES = 100_000  # [ns]


# Threads that waited when their virtual time ended. They go on, but nothing depends on them.
_left_over: weakref.WeakSet[threading.Thread] = weakref.WeakSet()


class DeadlockError(RuntimeError):
    """Every thread waits, without a deadline, for something that only another thread could do."""


class VirtualWaker(Waker):
    """The alarm of a thread that waits in virtual time."""

    __slots__ = ("_driver", "called")

    def __init__(self, driver: VirtualDriver) -> None:
        super().__init__()
        self._driver = driver
        self.called = False

    def wake(self) -> None:
        """Wake the sleeper, and note that it can go on."""
        self.called = True
        super().wake()  # for a wait that began or goes on after the virtual clock was taken away
        self._driver.note_wake()


class PolledWaker(VirtualWaker):
    """The alarm of a thread that waits for something that cannot call back.

    The choice of the next thread asks for it.
    """

    __slots__ = ("_has_come",)

    def __init__(self, driver: VirtualDriver, has_come: Callable[[], bool]) -> None:
        self._has_come = has_come
        super().__init__(driver)

    @property
    def called(self) -> bool:
        """Whether it has come."""
        return self._has_come()

    @called.setter
    def called(self, _: bool) -> None:
        pass


class Member:
    """A thread in virtual time."""

    __slots__ = ("error", "gate", "name", "number", "until", "waker", "was_woken")

    def __init__(self, number: int, name: str) -> None:
        self.number = number
        self.name = name
        self.gate = _thread.allocate_lock()  # held while it may not run
        self.gate.acquire()
        self.waker: Waker | None = None  # what it waits for; None: nothing but its turn
        self.until: int | None = None
        self.was_woken = False
        self.error: BaseException | None = None


class _Visit:
    """Lives in an unannounced thread, and calls `leave` when the thread ends."""

    __slots__ = ("_leave",)

    def __init__(self, leave: Callable[[], None]) -> None:
        self._leave = leave

    def __del__(self) -> None:
        self._leave()


class VirtualDriver:
    """Gives time and turns to threads; see the module. The thread that makes it has the first turn."""

    side: Side | None = None
    # A loop that polls the clock and never blocks would wait for ever. After this number of readings, each
    # further one takes some time.
    patience = 1000

    def __init__(self, seed: int = 0, start: int = START) -> None:
        self._now = 0
        self._start = start
        self._readings = 0
        self._random = random.Random(seed)
        # Guards what follows; held for moments, nothing is called inside. Reentrant for the sake of signal
        # handlers.
        self._lock = _thread.RLock()
        self._members: dict[int, Member] = {}  # by thread id; by minus its number before a thread has begun
        self._numbers = 0
        self._visits = threading.local()
        self._closed = False
        self._running: Member | None = self._add(
            _thread.get_ident(), "main"
        )  # None: all wait for somebody outside

    def monotonic_ns(self) -> int:
        """The virtual steady time [ns]."""
        self._readings += 1
        if self._readings > self.patience:
            self._now += _READING_TAKES
        return self._now

    def time_ns(self) -> int:
        """The virtual system time [ns since 1970]."""
        return self._start + self.monotonic_ns()

    def waker(self, *, lasting: bool = False) -> Waker:
        """Make an alarm for one sleeper."""
        return VirtualWaker(self)

    def wait(self, waker: Waker, until: int | None) -> bool:
        """Hand over until woken or due. An unknown thread becomes a member, unless it is left over."""
        if not isinstance(waker, VirtualWaker):
            raise RuntimeError(
                "this executor (or whatever else waits here) was made before the virtual clock was put in "
                "place: make contexts, nodes and executors inside `with virtual_time():`"
            )
        if self._closed or (_left_over and threading.current_thread() in _left_over):
            return self._wait_really(waker, until)
        with self._lock:
            ident = _thread.get_ident()
            me = self._members.get(ident)
            if me is None:
                me = self._add(ident, threading.current_thread().name)
                self._visits.end = _Visit(partial(self._leave, ident))
            me.waker, me.until = waker, until
            if self._running is me or self._running is None:
                self._hand_over()
        self._await_turn(me)
        if self._closed and not me.was_woken:
            return self._wait_really(waker, until)
        return me.was_woken

    def announce(self, thread: threading.Thread) -> Member:
        """Make a member of a thread that is about to start."""
        with self._lock:
            number = -(self._numbers + 1)
            return self._add(number, thread.name)

    def enter(self, me: Member) -> None:
        """Wait for the first turn; called on the thread itself, before anything else."""
        with self._lock:
            self._members[_thread.get_ident()] = self._members.pop(-me.number)
        self._await_turn(me)

    def leave(self) -> None:
        """Hand over for good; called on the thread itself, after everything else."""
        self._leave(_thread.get_ident())

    def _leave(self, ident: int) -> None:
        with self._lock:
            if self._members.pop(ident, None) is self._running and not self._closed:
                self._hand_over()

    def close(self) -> None:
        """End virtual time: waiting threads continue to wait in real time.

        Another driver is in place already.
        """
        with self._lock:
            self._closed = True
            self._members.pop(_thread.get_ident(), None)
            _left_over.update(thread for thread in threading.enumerate() if thread.ident in self._members)
            for member in self._members.values():
                if member is not self._running:
                    member.gate.release()
            self._members.clear()

    def note_wake(self) -> None:
        """Called after every `wake`: if everybody waits for somebody outside, that may just have come."""
        if self._running is None and not self._closed:
            with self._lock:
                if self._running is None:
                    self._hand_over()

    def _wait_really(self, waker: Waker, until: int | None) -> bool:
        """Wait after virtual time has ended: what is left of the time, in real time."""
        return timing.SYSTEM.wait(
            waker, None if until is None else timing.SYSTEM.monotonic_ns() + until - self._now
        )

    def _add(self, key: int, name: str) -> Member:
        self._numbers += 1
        me = self._members[key] = Member(self._numbers, name)
        return me

    def _await_turn(self, me: Member) -> None:
        interruption: BaseException | None = None
        while True:
            try:
                me.gate.acquire()
                break
            except BaseException as error:  # Ctrl-C: go on with it, but in turn
                interruption = error
                me.waker = None
                self.note_wake()
        if interruption is not None:
            raise interruption
        deadlock, me.error = me.error, None
        if deadlock is not None:
            raise deadlock

    def _hand_over(self) -> None:
        """Choose the next thread and open its gate. The lock is held."""
        self._readings = 0
        chosen = self._running = self._choose() or self._stuck()
        if chosen is None:
            return
        waker = chosen.waker
        chosen.was_woken = isinstance(waker, VirtualWaker) and waker.called
        if isinstance(waker, VirtualWaker):
            waker.called = False
            waker.sleep(0)
        chosen.waker = chosen.until = None
        chosen.gate.release()

    def _choose(self) -> Member | None:
        members = sorted(self._members.values(), key=lambda member: member.number)
        while members:
            able = [member for member in members if self._can_run(member)]
            if able:
                return self._random.choice(able)
            deadlines = [member.until for member in members if member.until is not None]
            if not self._let_time_pass(min(deadlines, default=None)):
                return None
        return None

    def _let_time_pass(self, deadline: int | None) -> bool:
        """Pass to the next deadline [ns, steady], when nobody can run; returns False if there is none."""
        if deadline is None:
            return False
        self._now = max(self._now, deadline)
        return True

    def _can_run(self, member: Member) -> bool:
        waker = member.waker
        if waker is None or (isinstance(waker, VirtualWaker) and waker.called):
            return True
        return member.until is not None and member.until <= self._now

    def _stuck(self) -> Member | None:
        """Return the member that raises DeadlockError; None if a thread that is no member may yet help."""
        if not self._members or any(self._may_help(thread) for thread in threading.enumerate()):
            return None
        first = min(self._members.values(), key=lambda member: member.number)
        names = ", ".join(member.name for member in self._members.values())
        first.error = DeadlockError(
            "Nothing will ever happen again: each of these threads waits for another one, without a timeout: "
            f"{names}"
        )
        return first

    def _may_help(self, thread: threading.Thread) -> bool:
        """True if a thread could wake a member: it is not a member, and no earlier block has left it over."""
        return (
            thread.ident not in self._members
            and thread is not threading.current_thread()
            and thread not in _left_over
        )


Driven = TypeVar("Driven", bound=VirtualDriver)


@contextmanager
def virtual_time(seed: int = 0, start: int = START) -> Generator[VirtualDriver]:
    """Run the block in virtual time; `start` is what the system clock shows first [ns since 1970]."""
    with driven_by(VirtualDriver(seed, start)) as driver:
        yield driver


@contextmanager
def driven_by(driver: Driven) -> Generator[Driven]:
    """Run the block on this driver, which has been made for it."""
    # Imported here: only tests need it, and it looks into threading's insides.
    from rmw_local.cooperative import cooperative_threading

    old = timing.install(driver)
    try:
        with cooperative_threading(driver):
            yield driver
    finally:
        timing.install(old)
        driver.close()

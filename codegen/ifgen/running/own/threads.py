"""Gives each program in company its own main thread and its own threads, which end when it ends.

Python interrupts only the main thread of a process while it waits. So the waiting functions of the standard
library wait in steps here: between two steps a program notices an interruption.
"""

from __future__ import annotations

import _thread
import itertools
import selectors
import sys
import threading
import time
import traceback
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

from ifgen.running.companion import Companion, current, work_for, working_for
from ifgen.running.ending import without_ours
from ifgen.running.exchange import exchanged
from ifgen.running.main_code import starting
from ifgen.running.own.attributes import OwnAttributes

_STEP = 0.05  # [s]

_real_sleep = time.sleep


class OwnThreads:
    """Does so while it is entered.

    `notice` is called between two steps of waiting, on the thread that waits.
    """

    def __init__(self, notice: Callable[[], None]) -> None:
        self._notice = notice
        self._start = threading.Thread.start
        self._join = threading.Thread.join
        self._main_thread = threading.main_thread
        self._enumerate = threading.enumerate
        self._report = threading.excepthook
        self._ended: dict[threading.Thread, threading.Event] = {}
        self._numbers: defaultdict[Companion | None, Iterator[int]] = defaultdict(lambda: itertools.count(1))
        self._stack = ExitStack()

    def __enter__(self) -> OwnThreads:
        notice = staticmethod(self._notice)
        self._numbers[None] = iter(threading._counter, None)  # type: ignore[attr-defined]
        self._stack.enter_context(OwnAttributes(threading, "excepthook"))
        self._stack.enter_context(
            exchanged(
                (threading.Thread, "start", _method(self._start_for)),
                (threading.Thread, "join", _method(self._wait_for)),
                (threading, "main_thread", self._main_thread_here),
                (threading, "enumerate", self._threads_here),
                (threading, "active_count", lambda: len(self._threads_here())),
                # The first thread of a program without a name is its Thread-1.
                (threading, "_counter", lambda: next(self._numbers[current()])),
                # The waiting primitive of a Condition, and so of an Event, a Queue and a Future.
                (threading, "_allocate_lock", lambda: _SteppedLock(self._notice)),
                (time, "sleep", self._sleep),
                # The waiting primitive of asyncio's loops.
                (
                    selectors,
                    "DefaultSelector",
                    type("DefaultSelector", (_SteppedSelector,), {"notice": notice}),
                ),
            )
        )
        threading.__dict__["excepthook"] = self._report_here  # where threads look for it
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def start_main(self, companion: Companion, run: Callable[[], None]) -> threading.Thread:
        """Start a thread that is the main thread of a program."""
        thread = companion.main_thread = threading.Thread(target=run, name="MainThread")
        with working_for(companion):
            self._start_for(thread)
        return thread

    def wait_for_others(self, companion: Companion, enough: threading.Event) -> None:
        """Wait for the threads of a program that are no daemons, as Python does, or for `enough`."""
        while not enough.is_set():
            alive = [thread for thread in list(companion.threads) if not thread.daemon]
            if not alive:
                return
            for thread in alive:
                _end_pool(thread)
            if alive[0].ident is None:  # it is just starting
                time.sleep(_STEP)
            else:
                self._wait_for(alive[0], _STEP)

    def _start_for(self, thread: threading.Thread) -> None:
        companion = current()
        if companion is None:
            self._start(thread)
            return
        run, daemon = thread.run, thread.daemon
        ended = self._ended[thread] = threading.Event()

        def run_for_companion() -> None:
            thread._daemonic = daemon  # type: ignore[attr-defined]  # what its own threads inherit
            work_for(companion)
            try:
                run()
            finally:
                ended.set()
                companion.threads.discard(thread)
                self._ended.pop(thread, None)

        if thread is not companion.main_thread:
            companion.threads.add(thread)
        thread.run = run_for_companion  # type: ignore[method-assign]
        # All of them are daemons for Python, so that a thread that does not end on request does not hold up
        # the process.
        thread._daemonic = True  # type: ignore[attr-defined]
        try:
            with starting:
                self._start(thread)
        except BaseException:
            companion.threads.discard(thread)
            raise

    def _wait_for(self, thread: threading.Thread, timeout: float | None = None) -> None:
        ended = self._ended.get(thread)
        if current() is not None and ended is not None and thread is not threading.current_thread():
            if not ended.wait(timeout):
                return
            timeout = None
        self._join(thread, timeout)

    def _main_thread_here(self) -> threading.Thread:
        companion = current()
        if companion is None or companion.main_thread is None:
            return self._main_thread()
        here = threading.current_thread()
        return here if isinstance(here, HandlerThread) else companion.main_thread

    def _threads_here(self) -> list[threading.Thread]:
        companion = current()
        known = self._enumerate()
        if companion is None:
            return known
        return [thread for thread in known if thread is companion.main_thread or thread in companion.threads]

    def _report_here(self, args: Any) -> None:
        companion = current()
        if companion is not None and companion.leaving and args.exc_type is SystemExit:
            return
        if companion is not None and (threading, "excepthook") in companion.attributes:
            companion.attributes[threading, "excepthook"](args)
            return
        trace = without_ours(args.exc_traceback)
        if companion is None or args.exc_type is SystemExit or args.exc_value is None or sys.stderr is None:
            self._report(args)
            return
        name = args.thread.name if args.thread is not None else threading.get_ident()
        text = "".join(traceback.format_exception(args.exc_type, args.exc_value, trace))
        # In one piece: another program may print as well.
        print(f"Exception in thread {name}:\n{text}", end="", file=sys.stderr, flush=True)

    def _sleep(self, seconds: float) -> None:
        if current() is None or not seconds > _STEP:
            _real_sleep(seconds)
            return
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            _real_sleep(min(left, _STEP))
            self._notice()


class HandlerThread(threading.Thread):
    """Runs a signal handler of a program whose main thread does not come to it: it passes for that thread."""


class _SteppedLock:
    """A lock that is waited for in steps."""

    __slots__ = ("_lock", "_notice", "locked", "release")

    def __init__(self, notice: Callable[[], None]) -> None:
        self._notice = notice
        self._at_fork_reinit()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        if not blocking or current() is None:
            return self._lock.acquire(blocking, timeout)
        end = None if timeout < 0 else time.monotonic() + timeout
        while True:
            left = _STEP if end is None else min(_STEP, max(end - time.monotonic(), 0.0))
            if self._lock.acquire(timeout=left):
                return True
            self._notice()
            if end is not None and time.monotonic() >= end:
                return False

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self._lock = _thread.allocate_lock()
        self.release, self.locked = self._lock.release, self._lock.locked


class _SteppedSelector(selectors.DefaultSelector):
    """A selector that waits in steps."""

    notice: Callable[[], None]

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        if current() is None or (timeout is not None and timeout <= _STEP):
            return super().select(timeout)
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            left = _STEP if end is None else min(_STEP, end - time.monotonic())
            found = super().select(max(left, 0.0))
            if found or left < _STEP:
                return found
            self.notice()


def _end_pool(thread: threading.Thread) -> None:
    """Let a thread of a concurrent.futures executor end without a shutdown, as Python does at exit."""
    pools = sys.modules.get("concurrent.futures.thread")
    if pools is None or thread not in getattr(pools, "_threads_queues", ()):
        return
    arguments = getattr(thread, "_args", ())
    pool = arguments[0]() if arguments and callable(arguments[0]) else None
    if pool is not None:
        pool.shutdown(wait=False)


def _method(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function that a class treats as its own method."""

    def method(thread: threading.Thread, *positional: Any, **named: Any) -> Any:
        return function(thread, *positional, **named)

    return method

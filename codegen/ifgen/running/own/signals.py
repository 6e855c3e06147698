"""Gives each program in company its own signal handlers, which Python runs in a process's main thread only.

What ends programs (SIGINT, SIGTERM) goes to every one, any other signal to those that handle it; what a
program sends to itself, to that one. A handler runs on the main thread of its program where that waits (in
rclpy, `time.sleep`, an event, a join), else beside it.
"""

from __future__ import annotations

import inspect
import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from functools import partial
from types import FrameType
from typing import Any

from ifgen.running.companion import Companion, Handler, current, working_for
from ifgen.running.exchange import exchanged
from ifgen.running.own.threads import HandlerThread

ENDING = frozenset({signal.SIGINT, signal.SIGTERM})
_SOON = 0.1  # [s] in which a main thread that waits comes to its handlers
_PATIENCE = 1.0  # [s] with a handler that waits for the thread that waits for it
_STEP = 0.05  # [s]
_HARMLESS = frozenset(
    getattr(signal, name)
    for name in ("SIGCHLD", "SIGCONT", "SIGURG", "SIGWINCH", "SIGINFO")
    if hasattr(signal, name)
)
# A signal that stops a process stops all programs in it; 0 is not a signal.
_FOR_THE_PROCESS = {0, *(getattr(signal, name) for name in ("SIGSTOP", "SIGTSTP") if hasattr(signal, name))}


_held = threading.local()  # `before`: the signals that a thread that forks had blocked


class OwnSignals:
    """Does so while it is entered, on the main thread, which has to call `serve` meanwhile.

    `asked` is called when a signal comes that ends programs.
    """

    def __init__(self, companions: Sequence[Companion], asked: Callable[[int], None]) -> None:
        self._companions = companions
        self._asked = asked
        self._signal, self._getsignal = signal.signal, signal.getsignal
        self._kill = os.kill
        self._report = sys.unraisablehook
        self._errands: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._before: dict[int, Any] = {}  # the handlers of the process
        self._stack = ExitStack()

    def __enter__(self) -> OwnSignals:
        exchanges: list[tuple[Any, str, Any]] = [
            (signal, "signal", self._set_handler),
            (signal, "getsignal", self._handler),
            (signal, "set_wakeup_fd", self._set_wakeup),
            (signal, "raise_signal", self._send_here),
            (os, "kill", self._send),
            (sys, "unraisablehook", self._raise_again),
        ]
        if hasattr(signal, "pause"):
            exchanges.append((signal, "pause", self._pause))
        self._real = {name: getattr(owner, name) for owner, name, _ in exchanges}
        self._stack.enter_context(exchanged(*exchanges))
        if self._getsignal(signal.SIGINT) is signal.default_int_handler:
            self._take(signal.SIGINT)
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(
                before=self._hold, after_in_parent=self._release, after_in_child=self._become_one_of_many
            )
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()
        for number, handler in self._before.items():
            self._signal(number, handler)
        self._before.clear()

    def _hold(self) -> None:
        """Before a program forks: let signals wait until the child has its own handlers."""
        if current() is not None and self._before:
            _held.before = signal.pthread_sigmask(signal.SIG_BLOCK, self._before.keys())

    def _release(self) -> None:
        if (before := vars(_held).pop("before", None)) is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def _become_one_of_many(self) -> None:
        """Restore the program's handlers in a child that it has forked, which is a separate process."""
        companion = current()
        if companion is not None and self._before:
            self._before |= {n: companion.handlers[n] for n in self._before if n in companion.handlers}
            self.__exit__()
        self._release()

    def serve(self, timeout: float) -> None:
        """Do what programs need the main thread for; returns after `timeout` s, or after one thing."""
        with suppress(queue.Empty):
            self._errands.get(timeout=timeout)()

    def wake(self) -> None:
        """Let `serve` return."""
        self._errands.put(lambda: None)

    def notice(self) -> None:
        """Call the handlers that are due, on the main thread of a program."""
        companion = current()
        if companion is None or threading.current_thread() is not companion.main_thread:
            return
        if companion.due:
            self._call(companion, inspect.currentframe())
        # If a handler raises on a thread beside this one, raise it here before any of its effects.
        if companion.handling.acquire(timeout=_PATIENCE):
            companion.handling.release()

    def deliver(self, companion: Companion, number: int) -> None:
        """Do to a program what this signal would do to its process."""
        if companion.ended.is_set():
            return
        main = companion.main.thread_id
        if not companion.may_stop(main):

            def deliver_later() -> None:
                companion.wait_until_it_may_stop(main)
                self._deliver(companion, number)

            HandlerThread(target=deliver_later, name="signal", daemon=True).start()
        else:
            self._deliver(companion, number)

    def _deliver(self, companion: Companion, number: int) -> None:
        if companion.wakeup >= 0:
            with suppress(OSError):
                os.write(companion.wakeup, bytes([number]))
        handler = companion.handlers.get(number, self._default(number))
        if handler is signal.default_int_handler:
            companion.interrupt(KeyboardInterrupt())
        elif callable(handler):
            here = threading.current_thread() is companion.main_thread
            if not here and companion.ros.just_interrupts(number, handler):
                self._interrupt_ros(companion)
                return
            companion.due.append((handler, number))
            if here:
                self.notice()
                return
            companion.rouse()
            HandlerThread(target=self._call_late, args=(companion,), name="signal", daemon=True).start()
        elif handler == signal.SIG_DFL and number not in _HARMLESS:
            companion.vanish(128 + number)

    def _raise_again(self, lost: Any) -> None:
        """Raise an interruption once more that came where nothing can be raised: in a finaliser, say."""
        companion = current()
        if companion is not None and companion.main.is_interrupted_by(lost.exc_value):
            self._errands.put(partial(companion.interrupt, lost.exc_value))
        else:
            self._report(lost)

    def _interrupt_ros(self, companion: Companion) -> None:
        """Interrupt the main thread, which ends the contexts: else it would go on with those for a while."""
        end = companion.ros.invalidate_contexts
        companion.interrupt(KeyboardInterrupt(), end)

        def end_late() -> None:  # it waits outside rclpy
            time.sleep(_PATIENCE)
            end()

        HandlerThread(target=end_late, name="signal", daemon=True).start()

    def _call_late(self, companion: Companion) -> None:
        """Call what is due from beside the main thread, unless that comes to it by itself."""
        end = time.monotonic() + _SOON
        while companion.due and time.monotonic() < end and companion.main.ending is None:
            time.sleep(_SOON / 10)
        frames = sys._current_frames()  # pyright: ignore[reportPrivateUsage]  # documented; debuggers need it
        with working_for(companion), companion.handling:
            try:
                self._call(companion, frames.get(companion.main.thread_id or 0))
            except BaseException as error:
                companion.interrupt(error)

    def _call(self, companion: Companion, frame: FrameType | None) -> None:
        while companion.due:
            with suppress(IndexError):  # the other one was faster
                handler, number = companion.due.popleft()
                handler(number, frame)

    # ---- what programs call

    def _set_handler(self, number: int, handler: Handler) -> Handler:
        companion = current()
        if companion is None:
            return self._signal(number, handler)
        if threading.current_thread() is not threading.main_thread():
            raise ValueError("signal only works in main thread of the main interpreter")
        before = self._handler(number)
        if not callable(handler) and handler not in (signal.SIG_IGN, signal.SIG_DFL):
            raise TypeError("signal handler must be signal.SIG_IGN, signal.SIG_DFL, or a callable object")
        if number not in self._before:
            self._on_main_thread(lambda: self._take(number))
        companion.handlers[int(number)] = handler
        return before

    def _handler(self, number: int) -> Handler:
        companion = current()
        real: Handler = self._getsignal(number)
        if companion is None:
            return real
        return companion.handlers.get(int(number), self._default(number))

    def _default(self, number: int) -> Handler:
        handler: Handler = self._before[number] if number in self._before else self._getsignal(number)
        return handler

    def _set_wakeup(self, fd: int, *, warn_on_full_buffer: bool = True) -> int:
        companion = current()
        if companion is None:
            before: int = self._real["set_wakeup_fd"](fd, warn_on_full_buffer=warn_on_full_buffer)
            return before
        if threading.current_thread() is not threading.main_thread():
            raise ValueError("set_wakeup_fd only works in main thread of the main interpreter")
        before, companion.wakeup = companion.wakeup, fd
        return before

    def _send(self, process: int, number: int) -> None:
        companion = current()
        if companion is None or process != os.getpid() or number in _FOR_THE_PROCESS:
            self._kill(process, number)
        else:
            self._getsignal(number)  # ValueError for what is no signal
            self.deliver(companion, number)

    def _send_here(self, number: int) -> None:
        self._send(os.getpid(), number)

    def _pause(self) -> None:
        """Wait for a signal that the program handles."""
        companion = current()
        if companion is None or threading.current_thread() is not companion.main_thread:
            self._real["pause"]()
            return
        while not companion.due:
            time.sleep(_STEP)
        self.notice()

    # ---- the process's own

    def _take(self, number: int) -> None:
        self._before[number] = self._signal(number, self._on_signal)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        for companion in self._companions:
            if number in ENDING or number in companion.handlers:
                self.deliver(companion, number)
        if number in ENDING:
            self._asked(number)

    def _on_main_thread(self, do: Callable[[], None]) -> None:
        done = threading.Event()
        problems: list[BaseException] = []

        def errand() -> None:
            try:
                do()
            except BaseException as error:
                problems.append(error)
            done.set()

        self._errands.put(errand)
        done.wait()
        if problems:
            raise problems[0]

"""The state that a program takes for process-wide: default context, global executor, log levels, Ctrl-C.

Normally there is one program a process. `ifgen run a.py : b.py` runs several in one, and lets each thread
have the `Program` that it works for (`shared`); all of rclpy asks `current`.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import weakref
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from rmw_local import timing

if TYPE_CHECKING:
    from rclpy.context import Context


class Program:
    """One `main()` with everything that it thinks it has for itself."""

    def __init__(self) -> None:
        self.lock = threading.RLock()  # guards default_context
        self.default_context: Context | None = None
        self.global_executor: Any = None  # an Executor; typed Any to keep this module below all others
        self.logging: Any = None  # what `rcl.logging` keeps
        self.logging_users = 0  # contexts that have initialised it
        self.rosout: Any = None  # what `rcl.rosout` keeps
        self.signal_options = 0  # what install_signal_handlers asked for
        self.signal_handler: Any = None  # rclpy's own, once it is installed
        self.earlier_handlers: dict[int, Any] = {}  # signal number -> the handler before rclpy
        self.contexts: weakref.WeakSet[Any] = weakref.WeakSet()  # handles that were made here
        # Guard conditions that Ctrl-C triggers.
        self.interrupt_guards: weakref.WeakSet[Any] = weakref.WeakSet()

    def just_interrupts(self, number: int, handler: Any) -> bool:
        """Return whether all that a signal's handler does is `invalidate_contexts` and KeyboardInterrupt."""
        earlier = self.earlier_handlers.get(number)
        return handler is self.signal_handler and earlier is signal.default_int_handler

    def invalidate_contexts(self) -> None:
        """Do what rclpy does on SIGINT or SIGTERM: end every context and wake every executor.

        Takes no lock.
        """
        for context in list(self.contexts):
            context.invalidate()
        for guard in list(self.interrupt_guards):
            with contextlib.suppress(RuntimeError):  # it is being destroyed
                guard.trigger_guard_condition()

    def leave(self) -> None:
        """Take out of the graph what the program has left there, as the end of its process would."""
        self.invalidate_contexts()
        for context in list(self.contexts):
            context.participant.leave()

    def renew_locks(self) -> None:
        """Start over in a fork: threads that do not exist there may have held any lock."""
        self.lock = threading.RLock()
        for kept in (self.logging, self.rosout):
            if kept is not None:
                kept.renew_locks()

    def rouse(self, thread_id: int) -> None:
        """Let a thread look up from what it waits for in rclpy: it raises what is due, or waits again."""
        timing.driver.rouse(thread_id)


WHOLE_PROCESS = Program()


def _whole_process() -> Program:
    return WHOLE_PROCESS


# Call it through the module, `program.current()`: `shared` exchanges it.
current: Callable[[], Program] = _whole_process
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=lambda: current().renew_locks())


@contextlib.contextmanager
def shared(find: Callable[[], Program | None], notice: Callable[[], None]) -> Iterator[None]:
    """Let several programs share the process: `find` returns the one that a thread works for, None for none.

    `notice` is called on every thread that has been woken from a wait.
    """
    global current  # noqa: PLW0603 - see there
    alone, driver = current, timing.install(_NoticingDriver(notice))
    current = lambda: find() or WHOLE_PROCESS  # noqa: E731
    try:
        yield
    finally:
        current = alone
        timing.install(driver)


class _NoticingDriver(timing.SystemDriver):
    """System time, for threads that have something else to look after as well."""

    def __init__(self, notice: Callable[[], None]) -> None:
        super().__init__()
        self._notice = notice

    def wait(self, waker: timing.Waker, until: int | None) -> bool:
        """Block this thread as the system does, then notice an interruption."""
        woken = super().wait(waker, until)
        self._notice()
        return woken

"""The state that rclpy has once in a process: default context, global executor, log levels, Ctrl-C."""

from __future__ import annotations

import contextlib
import threading
import weakref
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rclpy.context import Context


class Program:
    """Everything that a process has once."""

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

    def invalidate_contexts(self) -> None:
        """Do what rclpy does on SIGINT or SIGTERM: end every context and wake every executor.

        Takes no lock.
        """
        for context in list(self.contexts):
            context.invalidate()
        for guard in list(self.interrupt_guards):
            with contextlib.suppress(RuntimeError):  # it is being destroyed
                guard.trigger_guard_condition()


_PROGRAM = Program()


def current() -> Program:
    """The state of this process."""
    return _PROGRAM

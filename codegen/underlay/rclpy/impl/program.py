"""What a program believes to be process-wide: its arguments, default context, global executor and Ctrl-C.

Normally there is one program a process. A runner of several puts its own lookup in place of `current`
(`ifgen run a.py : b.py` gives each program's threads a `Program` of its own); all of rclpy asks here.
"""

from __future__ import annotations

import contextlib
import sys
import threading
import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rclpy.context import Context


class Program:
    """One `main()` with everything that it thinks it has for itself."""

    def __init__(self, argv: list[str] | None = None) -> None:
        self._argv = argv
        self.lock = threading.RLock()  # guards default_context
        self.default_context: Context | None = None
        self.global_executor: Any = None  # an Executor; typed Any to keep this module below all others
        self.signal_options = 0  # what install_signal_handlers asked for
        self.contexts: weakref.WeakSet[Any] = weakref.WeakSet()  # handles that were made here
        self.interrupt_guards: weakref.WeakSet[Any] = (
            weakref.WeakSet()
        )  # guard conditions that Ctrl-C triggers

    @property
    def argv(self) -> list[str]:
        """The command line: an own one, or the process's."""
        return sys.argv if self._argv is None else self._argv

    def invalidate_contexts(self) -> None:
        """Do what rclpy does on SIGINT or SIGTERM: end every context and wake every executor.

        Takes no lock.
        """
        for context in list(self.contexts):
            context.invalidate()
        for guard in list(self.interrupt_guards):
            with contextlib.suppress(RuntimeError):  # it is being destroyed
                guard.trigger_guard_condition()


WHOLE_PROCESS = Program()


def _whole_process() -> Program:
    return WHOLE_PROCESS


# Call it through the module, `program.current()`: a runner exchanges it.
current: Callable[[], Program] = _whole_process

"""SIGINT and SIGTERM: they end every context, wake every executor, and go on to the handlers before."""

from __future__ import annotations

import signal
import threading
from types import FrameType

from rclpy.impl import program

from .enums import ScopedEnum
from .guard_condition import GuardCondition

__all__ = [
    "SignalHandlerOptions",
    "get_current_signal_handlers_options",
    "install_signal_handlers",
    "register_sigint_guard_condition",
    "uninstall_signal_handlers",
    "unregister_sigint_guard_condition",
]


class SignalHandlerOptions(ScopedEnum):
    """The signals that rclpy handles; the values are bits."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_SIGNALS = {1: signal.SIGINT, 2: signal.SIGTERM}


def install_signal_handlers(options: SignalHandlerOptions) -> None:
    """Handle these signals from now on; those handled already stay so."""
    here = program.current()
    here.signal_options |= options.value
    # Python hands signals to the main thread only.
    if threading.current_thread() is not threading.main_thread():
        return
    for bit, number in _SIGNALS.items():
        if options.value & bit and signal.getsignal(number) is not _handle:
            here.earlier_handlers[number] = signal.signal(number, _handle)
            here.signal_handler = _handle


def uninstall_signal_handlers() -> None:
    """Restore the handlers of before."""
    here = program.current()
    here.signal_options = 0
    if threading.current_thread() is not threading.main_thread():
        return
    for number, earlier in list(here.earlier_handlers.items()):
        if signal.getsignal(number) is _handle:  # else the program has replaced us: leave its handler alone
            signal.signal(number, earlier)
        del here.earlier_handlers[number]


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Return which signals are handled."""
    return SignalHandlerOptions(program.current().signal_options)


def register_sigint_guard_condition(guard: GuardCondition) -> None:
    """Let signals trigger this guard condition."""
    guard.context.program.interrupt_guards.add(guard)


def unregister_sigint_guard_condition(guard: GuardCondition) -> None:
    """Take back `register_sigint_guard_condition`."""
    try:
        guard.context.program.interrupt_guards.remove(guard)
    except KeyError:
        raise ValueError("Guard condition was not registered") from None


def _handle(number: int, frame: FrameType | None) -> None:
    # The main thread may hold any lock of ours at this point, so nothing here takes one.
    here = program.current()
    here.invalidate_contexts()
    earlier = here.earlier_handlers.get(number)
    if callable(earlier):
        earlier(number, frame)

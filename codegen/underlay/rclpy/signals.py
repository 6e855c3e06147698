"""Signals: which ones rclpy handles, and a guard condition that they trigger."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from rclpy.exceptions import InvalidHandle
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

if TYPE_CHECKING:
    from rclpy.context import Context

SignalHandlerOptions = _rclpy.SignalHandlerOptions


def install_signal_handlers(options: _rclpy.SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Handle SIGINT, SIGTERM or both: they end every context and wake every executor."""
    _rclpy.install_signal_handlers(options)


def get_current_signal_handlers_options() -> _rclpy.SignalHandlerOptions:
    """Return which signals are handled."""
    return _rclpy.get_current_signal_handlers_options()


def uninstall_signal_handlers() -> None:
    """Handle no signals any more."""
    _rclpy.uninstall_signal_handlers()


class SignalHandlerGuardCondition(GuardCondition):
    """A guard condition that is triggered by every signal that rclpy handles."""

    def __init__(self, context: Context | None = None) -> None:
        super().__init__(callback=None, callback_group=None, context=context)
        with self.handle:
            _rclpy.register_sigint_guard_condition(self.handle)

    def __del__(self) -> None:
        with contextlib.suppress(InvalidHandle, ValueError, AttributeError):  # destroyed, or never quite made
            self.destroy()

    def destroy(self) -> None:
        """Unregister and destroy it."""
        with self.handle:
            _rclpy.unregister_sigint_guard_condition(self.handle)
        super().destroy()

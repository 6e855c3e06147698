"""Guard conditions: callbacks that run in an executor when they are triggered."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.reexports import reexport
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup
    from rclpy.context import Context
else:
    __getattr__ = reexport(__name__)


class GuardCondition:
    """A flag with a callback; made by `Node.create_guard_condition`."""

    def __init__(
        self,
        callback: Callable[[], object] | None,
        callback_group: CallbackGroup | None,
        context: Context | None = None,
    ) -> None:
        self._context = get_default_context() if context is None else context
        with self._context.handle:
            self.__gc = _rclpy.GuardCondition(self._context.handle)
        self.callback = callback
        self.callback_group = callback_group
        self._executor_event = False  # a handler exists that has not yet taken its data
        self._executor_triggered = False  # an executor has seen the trigger and not yet called back

    def trigger(self) -> None:
        """Have the callback run soon; any thread."""
        with self.__gc:
            self.__gc.trigger_guard_condition()

    @property
    def handle(self) -> _rclpy.GuardCondition:
        """The client library's side."""
        return self.__gc

    def destroy(self) -> None:
        """Destroy it; programs use `Node.destroy_guard_condition`."""
        self.handle.destroy_when_not_in_use()

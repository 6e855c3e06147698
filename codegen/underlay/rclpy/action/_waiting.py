"""The waiting of executors for both ends of an action."""

from __future__ import annotations

from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any

from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.waitable import NumberOfEntities, Waitable

if TYPE_CHECKING:
    from rclpy.callback_groups import CallbackGroup


class ActionWaitable(Waitable):
    """Waits for the parts of one handle, and takes one thing of each part that was found ready."""

    def __init__(self, callback_group: CallbackGroup) -> None:
        super().__init__(callback_group)
        self._waited_for: _rclpy.ActionClient | _rclpy.ActionServer
        self._ready: Sequence[bool] = ()  # what was found last, in the handle's order

    def _wait_for(self, handle: _rclpy.ActionClient | _rclpy.ActionServer) -> None:
        """Wait for this handle from now on."""
        self._waited_for = handle
        self._fixed_handles = handle.handles

    def is_ready(self, wait_set: _rclpy.WaitSet) -> bool:
        """Return whether something of this is ready in the wait set."""
        self._ready = self._waited_for.is_ready(wait_set)
        return any(self._ready)

    def _find_ready(self) -> bool:
        """Look for ready parts of the action."""
        self._ready = ready = [handle.is_ready() for handle in self._fixed_handles]
        return True in ready and not self._waited_for._destruction_requested

    def take_data(self) -> dict[str, Any]:
        """Take one of each kind that was found ready, and return them by kind."""
        try:
            with self._waited_for:
                return self._take_ready()
        except InvalidHandle:  # destroyed since it was found ready
            return {}

    def _take_ready(self) -> dict[str, Any]:
        raise NotImplementedError

    def get_num_entities(self) -> NumberOfEntities:
        """Return how many entities of each kind this adds to a wait set."""
        return NumberOfEntities(*self._waited_for.get_num_entities())

    def add_to_wait_set(self, wait_set: _rclpy.WaitSet) -> None:
        """Add the entities to a wait set."""
        self._waited_for.add_to_waitset(wait_set)

    def __enter__(self) -> None:
        self._waited_for.__enter__()

    def __exit__(
        self, t: type[BaseException] | None, v: BaseException | None, tb: TracebackType | None
    ) -> None:
        self._waited_for.__exit__(t, v, tb)

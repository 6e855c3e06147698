"""The action that starts the tests."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from launch.action import Action
from launch.launch_context import LaunchContext

__all__ = ["ReadyToTest"]


class ReadyToTest(Action):
    """Says that the processes are ready: the tests begin."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._calls: list[Callable[[], None]] = []

    def add_callback(self, call: Callable[[], None]) -> None:
        """Call a function when it is executed."""
        self._calls.append(call)

    def execute(self, context: LaunchContext) -> None:
        """Start the tests."""
        for call in self._calls:
            call()

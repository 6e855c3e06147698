"""The base of conditions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class Condition:
    """Decides whether an action is done, by a function of the context."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate
        self._last: bool | None = None

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether it holds; what it says is kept for later."""
        self._last = self._predicate(context) if self._predicate is not None else True
        return self._last

    def describe(self) -> str:
        """Return what it is, for people."""
        return self.__class__.__name__

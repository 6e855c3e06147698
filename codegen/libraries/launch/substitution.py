"""The base of substitutions: texts that are known once a description runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class Substitution:
    """A text that a description computes when it runs."""

    def describe(self) -> str:
        """Return what it is, for people."""
        return self.__class__.__name__

    def perform(self, context: LaunchContext) -> str:
        """Return its text in a context."""
        raise NotImplementedError(f"{type(self).__name__} does not define perform()")

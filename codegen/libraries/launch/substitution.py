"""The base of substitutions: texts that are known once a description runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class Substitution:
    """A text that a description computes when it runs."""

    @classmethod
    def parse(cls, data: Sequence[SomeSubstitutionsType]) -> tuple[type[Self], dict[str, Any]]:
        """Return the class and its arguments, as `$(name argument ...)` has them in XML and YAML."""
        if data:
            raise TypeError(f"{cls.__name__} takes no arguments, got {len(data)}")
        return cls, {}

    def describe(self) -> str:
        """Return what it is, for people."""
        return self.__class__.__name__

    def perform(self, context: LaunchContext) -> str:
        """Return its text in a context."""
        raise NotImplementedError(f"{type(self).__name__} does not define perform()")

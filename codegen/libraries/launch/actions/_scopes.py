"""Beginnings and ends of scopes, which groups are made of."""

from __future__ import annotations

import os
from collections.abc import Mapping

from launch.action import Action
from launch.condition import Condition
from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import performed

_FIRST = dict(os.environ)


class PushLaunchConfigurations(Action):
    """Keeps the launch configurations."""

    def execute(self, context: LaunchContext) -> None:
        """Keep them."""
        context.push_launch_configurations()


class PopLaunchConfigurations(Action):
    """Returns to the launch configurations that were kept."""

    def execute(self, context: LaunchContext) -> None:
        """Return to them."""
        context.pop_launch_configurations()


class PushEnvironment(Action):
    """Keeps the environment."""

    def execute(self, context: LaunchContext) -> None:
        """Keep it."""
        context.push_environment()


class PopEnvironment(Action):
    """Returns to the environment that was kept."""

    def execute(self, context: LaunchContext) -> None:
        """Return to it."""
        context.pop_environment()


class ResetEnvironment(Action):
    """Returns to the environment that the launch started with."""

    def execute(self, context: LaunchContext) -> None:
        """Return to it."""
        context.set_environment(_FIRST)


class ResetLaunchConfigurations(Action):
    """Removes all launch configurations except those that are given."""

    def __init__(
        self,
        launch_configurations: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        *,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.launch_configurations = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> None:
        """Remove them. The values that are given are computed first."""
        kept = {performed(context, k): performed(context, v) for k, v in self.launch_configurations.items()}
        context.launch_configurations.clear()
        context.launch_configurations.update(kept)

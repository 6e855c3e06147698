"""Environment variables of the processes that start later, and scopes of these and of configurations."""

from __future__ import annotations

import os
from collections.abc import Mapping

from launch.action import Action
from launch.condition import Condition
from launch.conditions import evaluate_condition_expression
from launch.launch_context import LaunchContext
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions, performed


class SetEnvironmentVariable(Action):
    """Sets an environment variable."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        *,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(value)

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        name = perform_substitutions(context, self.name)
        context.environment[name] = perform_substitutions(context, self.value)


class UnsetEnvironmentVariable(Action):
    """Removes an environment variable, which may not exist."""

    def __init__(self, name: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Remove it."""
        context.environment.pop(perform_substitutions(context, self.name), None)


class AppendEnvironmentVariable(Action):
    """Adds to an environment variable, after a separator, or with `prepend` before one."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        *,
        prepend: bool | SomeSubstitutionsType = False,
        separator: SomeSubstitutionsType = os.pathsep,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(value)
        self.prepend = str(prepend) if isinstance(prepend, bool) else prepend
        self.separator = normalize_to_list_of_substitutions(separator)

    def execute(self, context: LaunchContext) -> None:
        """Add it. Raises RuntimeError."""
        name, value = perform_substitutions(context, self.name), perform_substitutions(context, self.value)
        before = context.environment.get(name)
        if before is not None:
            ends = (
                (value, before) if evaluate_condition_expression(context, self.prepend) else (before, value)
            )
            value = performed(context, self.separator).join(ends)
        context.environment[name] = value


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


class ReplaceEnvironmentVariables(Action):
    """Replaces the whole environment by variables that may have substitutions."""

    def __init__(
        self,
        environment: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        *,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.environment = dict(environment or {})

    def execute(self, context: LaunchContext) -> None:
        """Replace it. The values are computed in the one before."""
        given = {performed(context, k): performed(context, v) for k, v in self.environment.items()}
        context.set_environment(given)


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

# Lambdas of users take any arguments are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Actions that contain others: groups, other files, functions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from launch.action import Action
from launch.actions._arguments import SetLaunchConfiguration
from launch.actions._scopes import (
    PopEnvironment,
    PopLaunchConfigurations,
    PushEnvironment,
    PushLaunchConfigurations,
    ResetEnvironment,
    ResetLaunchConfigurations,
)
from launch.condition import Condition
from launch.event_handler import as_list
from launch.launch_context import LaunchContext
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.launch_description_source import LaunchDescriptionSource
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.some_entities_type import SomeEntitiesType
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import performed

_OF_FILES = ("current_launch_file_path", "current_launch_file_directory")


class GroupAction(Action):
    """Actions together; what they set ends with the group, unless it is not `scoped`.

    Without `forwarding` a scoped group begins with no launch configurations but those that are given.
    """

    def __init__(
        self,
        actions: Iterable[Action],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.actions: list[LaunchDescriptionEntity] = as_list(actions)
        self.scoped = scoped
        self.forwarding = forwarding
        self.launch_configurations = dict(launch_configurations or {})

    def describe_sub_entities(self) -> Sequence[LaunchDescriptionEntity]:
        """Return its actions, which run whenever it does."""
        return self.actions

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Return its actions, within their scope."""
        sets = [SetLaunchConfiguration(name, value) for name, value in self.launch_configurations.items()]
        if not self.scoped:
            return [*sets, *self.actions]
        first = (
            sets
            if self.forwarding
            else [ResetEnvironment(), ResetLaunchConfigurations(self.launch_configurations)]
        )
        before, after = (
            [PushLaunchConfigurations(), PushEnvironment()],
            [PopEnvironment(), PopLaunchConfigurations()],
        )
        return [*before, *first, *self.actions, *after]


class IncludeLaunchDescription(Action):
    """Another description, most often of a file, with arguments for it."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | SomeSubstitutionsType,
        *,
        launch_arguments: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.launch_description_source = (
            launch_description_source
            if isinstance(launch_description_source, LaunchDescriptionSource)
            else AnyLaunchDescriptionSource(launch_description_source)
        )
        self.launch_arguments = [] if launch_arguments is None else list(launch_arguments)

    def describe(self) -> str:
        """Return where the description comes from."""
        return f"IncludeLaunchDescription({self.launch_description_source.location})"

    def describe_sub_entities(self) -> Sequence[LaunchDescriptionEntity]:
        """Return the description if it is there already."""
        description = self.launch_description_source.try_get_launch_description_without_context()
        return [] if description is None else [description]

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Return the description, after what sets its arguments. Raises RuntimeError if one is missing."""
        description = self.launch_description_source.get_launch_description(context)
        given = {performed(context, name) for name, _ in self.launch_arguments}
        # Those of the command line are the file's own business: its message says how to add them.
        needed = [] if self.place is None else description.get_launch_arguments()
        for argument in needed:
            if (
                argument.conditionally_included
                or argument.default_value is not None
                or argument.name in given
            ):
                continue
            if argument.name in context.launch_configurations:
                continue
            raise RuntimeError(
                f"the included launch file needs the argument '{argument.name}' ({argument.description}), "
                f"and is given {', '.join(sorted(given)) or 'none'}"
            )
        locals_before = context.get_locals_as_dict()
        before = {name: locals_before[name] for name in _OF_FILES if name in locals_before}

        def leave(context: LaunchContext) -> None:
            context.remove_locals(*_OF_FILES)
            context.extend_locals(before)

        path = Path(self.launch_description_source.location).absolute()
        inside = {"current_launch_file_path": str(path), "current_launch_file_directory": str(path.parent)}
        sets = [SetLaunchConfiguration(name, value) for name, value in self.launch_arguments]
        enter = OpaqueFunction(function=lambda context: context.extend_locals(inside))
        return [*sets, enter, description, OpaqueFunction(function=leave)]


class OpaqueFunction(Action):
    """A function that is called with the context, and may return entities."""

    def __init__(
        self,
        *,
        function: Callable[..., SomeEntitiesType | None],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.function = function
        self.args = list(args or ())
        self.kwargs = dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Call it, and return its entities."""
        return as_list(self.function(context, *self.args, **self.kwargs))

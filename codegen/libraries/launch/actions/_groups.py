# Lambdas of users take any arguments are Any.
# pyright: reportUnknownArgumentType=false, reportUnknownLambdaType=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
"""Actions that contain others: groups, other files, functions."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from launch.action import Action
from launch.actions._environment import (
    PopEnvironment,
    PopLaunchConfigurations,
    PushEnvironment,
    PushLaunchConfigurations,
    ResetEnvironment,
    ResetLaunchConfigurations,
)
from launch.actions.declare_launch_argument import SetLaunchConfiguration
from launch.condition import Condition
from launch.event_handler import as_list
from launch.launch_context import LaunchContext
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.launch_description_source import LaunchDescriptionSource
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.some_entities_type import SomeEntitiesType
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions, performed

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


class OpaqueCoroutine(Action):
    """A coroutine that is called with the context, unless it is to be ignored, and keeps the launch alive."""

    def __init__(
        self,
        *,
        coroutine: Callable[..., Awaitable[None]],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        ignore_context: bool = False,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        if not inspect.iscoroutinefunction(coroutine):
            raise TypeError(f"OpaqueCoroutine expects a coroutine function, got {coroutine!r}")
        self.coroutine = coroutine
        self.args = list(args or ())
        self.kwargs = dict(kwargs or {})
        self.ignore_context = ignore_context
        self._task: asyncio.Task[None] | None = None

    def ends_later(self) -> bool:
        """Return True: it goes on until the coroutine returns."""
        return True

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Return the task of the coroutine; None before it is executed."""
        return self._task

    def execute(self, context: LaunchContext) -> None:
        """Start it. A shutdown cancels it, and what it raises is an error of the description."""
        first = [] if self.ignore_context else [context]
        assert context.asyncio_loop is not None, "the launch runs"
        self._task = context.asyncio_loop.create_task(self.coroutine(*first, *self.args, **self.kwargs))
        context.add_completion_future(self._task)
        self._task.add_done_callback(lambda task: context.host.post(lambda: self._finish(task, context)))

    def _finish(self, task: asyncio.Task[None], context: LaunchContext) -> None:
        if not task.cancelled():
            task.result()
        context.host.completed(self)


class ForEach(Action):
    """Entities for each set of values in `{'a': 1};{'a': 2}`, from a function of these values."""

    def __init__(
        self,
        input_values: SomeSubstitutionsType,
        *,
        function: Callable[..., SomeEntitiesType | None],
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.input_values = normalize_to_list_of_substitutions(input_values)
        self.function = function

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Call the function for each set. Raises ValueError."""
        import yaml  # few descriptions have one

        found: list[LaunchDescriptionEntity] = []
        text = perform_substitutions(context, self.input_values)
        for each in (part for part in text.split(";") if part.strip()):
            values = yaml.safe_load(each)
            if not isinstance(values, dict):
                raise ValueError(
                    f"ForEach expects sets such as {{'a': 1}}, with ';' between them, got '{each}'"
                )
            found += as_list(self.function(**values))
        return found


class ForLoop(Action):
    """Entities for each number from 0 below a length, from a function of the number."""

    def __init__(
        self,
        length: int | SomeSubstitutionsType,
        *,
        function: Callable[[int], SomeEntitiesType | None],
        name: str = "i",
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.length: list[Substitution] = (
            [TextSubstitution(text=str(length))]
            if isinstance(length, int)
            else normalize_to_list_of_substitutions(length)
        )
        self.function = function
        self.name = name

    def execute(self, context: LaunchContext) -> Sequence[LaunchDescriptionEntity]:
        """Call the function for each number. Raises ValueError."""
        text = perform_substitutions(context, self.length)
        if not text.strip().isdecimal():
            raise ValueError(f"the length of ForLoop must be a whole number, got '{text}'")
        return [each for number in range(int(text)) for each in as_list(self.function(number))]

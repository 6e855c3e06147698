"""The arguments of descriptions, for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription

_MAX_DEPTH = 50


def arguments(
    description: LaunchDescription, path: str, context: LaunchContext
) -> list[DeclareLaunchArgument]:
    """Return the arguments of a file, and of the files that it includes by paths known before it runs."""
    found: dict[str, DeclareLaunchArgument] = {}
    for each in _files(description, path, context, 0):
        for argument in each.get_launch_arguments():
            found.setdefault(argument.name, argument)
    return list(found.values())


def arguments_in_words(found: Iterable[DeclareLaunchArgument]) -> Iterator[str]:
    """The lines of `--show-args`."""
    yield "Arguments (pass arguments as '<name>:=<value>'):"
    listed = list(found)
    if not listed:
        yield ""
        yield "  No arguments."
        return
    for argument in listed:
        yield ""
        yield f"    '{argument.name}':{'*' if argument.conditionally_included else ''}"
        yield f"        {argument.description}"
        if argument.default_value is not None:
            default = " + ".join(each.describe() for each in argument.default_value)
            yield f"        (default: {default})"
    if any(argument.conditionally_included for argument in listed):
        yield ""
        yield "* argument(s) which are only used if specific conditions occur"


def _files(
    description: LaunchDescription, path: str, context: LaunchContext, depth: int
) -> Iterator[LaunchDescription]:
    yield description
    if depth >= _MAX_DEPTH:
        return
    file = Path(path).absolute()
    here = {"current_launch_file_path": str(file), "current_launch_file_directory": str(file.parent)}
    for include in _includes(description):
        with suppress(Exception):  # it needs what is known only when the launch runs
            context.extend_locals(here)
            source = include.launch_description_source
            included = source.get_launch_description(context)
            yield from _files(included, source.location, context, depth + 1)


def _includes(entity: LaunchDescriptionEntity) -> Iterator[IncludeLaunchDescription]:
    if isinstance(entity, IncludeLaunchDescription):
        yield entity
        return
    for each in entity.describe_sub_entities():
        yield from _includes(each)
    for _, entities in entity.describe_conditional_sub_entities():
        for each in entities:
            yield from _includes(each)

"""Commands that other packages add: entry points `name = "module:command"` in the group `ifgen.commands`."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

import click

if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.metadata import EntryPoint

_GROUP: Final = "ifgen.commands"


def names() -> list[str]:
    """The names of these commands."""
    return list(_entry_points())


def ends_as_tools_do(words: Sequence[str]) -> bool:
    """Whether a command line is one that `ros2` has, too, and that ends as there: with 2 after Ctrl-C."""
    found = command(words[0]) if words else None
    return getattr(found, "ends_as_in_ros", False)


def command(name: str) -> click.Command | None:
    """The command of this name, None if there is none.

    One that cannot be imported is a command that says so, and nothing is wrong with all others.
    """
    entry_point = _entry_points().get(name)
    if entry_point is None:
        return None
    try:
        found = entry_point.load()
    except Exception as error:  # whatever somebody's module raises
        return _broken(entry_point, f"{type(error).__name__}: {error}")
    if not isinstance(found, click.Command):
        return _broken(entry_point, "this is no click command")
    return found


def _broken(entry_point: EntryPoint, why: str) -> click.Command:
    of = f" of {entry_point.dist.name}" if entry_point.dist else ""
    message = f"the command {entry_point.name!r}{of} cannot be loaded from {entry_point.value}: {why}"

    def fail() -> None:
        raise click.ClickException(message)

    options = {"ignore_unknown_options": True, "allow_extra_args": True}
    return click.Command(
        entry_point.name, options, fail, short_help="Cannot be loaded.", add_help_option=False
    )


@cache
def _entry_points() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points  # commands of ifgen's own do without

    return {found.name: found for found in entry_points(group=_GROUP)}

"""All commands of `ifgen`, and the example in the help of each."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.metadata import entry_points

import click
from ifgen.cli.main import commands


def leaves() -> Iterator[tuple[str, click.Command]]:
    """Every command of ours that does something, as `ifgen topic list`."""
    points = entry_points(group="ifgen.commands")
    others = {point.name for point in points if not point.value.startswith(("ifgen.", "ifgen_tools."))}
    context = click.Context(commands)
    for name in commands.list_commands(context):
        command = commands.get_command(context, name)
        if command is not None and name not in others:
            yield from _below(f"ifgen {name}", command)


def _below(path: str, command: click.Command) -> Iterator[tuple[str, click.Command]]:
    if not isinstance(command, click.Group):
        yield path, command
        return
    # In the order of the program: a bag is recorded before it is played.
    for name, below in command.commands.items():
        yield from _below(f"{path} {name}", below)


def example(command: click.Command) -> str | None:
    """The command line at the end of a command's help, in backquotes if more text is there."""
    found = re.search(r"Example:\s+(?:`([^`]+)`|(ifgen .+))", command.epilog or "", re.DOTALL)
    return " ".join((found[1] or found[2]).split()) if found else None

"""The commands, ours and others': entry points `name = "module:command"` in the group `ifgen.commands`."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Final

import click

from ifgen.resources import VERSION

_GROUP: Final = "ifgen.commands"
_OURS: Final = f"ifgen_ros-{VERSION}.dist-info/entry_points.txt"


@dataclass(frozen=True, kw_only=True, slots=True)
class Plugin:
    """An entry point of the group, and the distribution that has it; None for ours."""

    name: str
    value: str
    distribution: str | None = None

    def load(self) -> object:
        """Import the module, and return what the entry point names."""
        module, _, attribute = self.value.partition(":")
        return getattr(import_module(module), attribute)


def names() -> list[str]:
    """The names of all commands."""
    return sorted({*_own(), *_others()})


def ends_as_tools_do(words: Sequence[str]) -> bool:
    """Whether a command line is one that `ros2` has, too, and that ends as there: with 2 after Ctrl-C."""
    return getattr(command(words[0]) if words else None, "ends_as_in_ros", False)


def command(name: str) -> click.Command | None:
    """The command of this name, None if there is none; ours come first.

    One that cannot be imported is a command that says so, and nothing is wrong with all others.
    """
    plugin = _own().get(name) or _others().get(name)
    if plugin is None:
        return None
    try:
        loaded = plugin.load()
    except Exception as error:  # whatever somebody's module raises
        return _broken(plugin, f"{type(error).__name__}: {error}")
    return loaded if isinstance(loaded, click.Command) else _broken(plugin, "this is no click command")


def _broken(plugin: Plugin, why: str) -> click.Command:
    of = f" of {plugin.distribution}" if plugin.distribution else ""
    message = f"the command {plugin.name!r}{of} cannot be loaded from {plugin.value}: {why}"

    def fail() -> None:
        raise click.ClickException(message)

    options = {"ignore_unknown_options": True, "allow_extra_args": True}
    return click.Command(plugin.name, options, fail, short_help="Cannot be loaded.", add_help_option=False)


@cache
def _own() -> dict[str, Plugin]:
    """Ours, from the file of our own distribution: importlib.metadata takes 20 ms of CPU to read it."""
    for folder in sys.path:
        file = Path(folder, _OURS)
        if file.is_file():
            pairs = _entry_points(file.read_text(encoding="utf-8"))
            return {name: Plugin(name=name, value=value) for name, value in pairs}
    return {}  # another version's metadata, as beside a checkout just updated: _others has the commands


def _entry_points(text: str) -> Iterator[tuple[str, str]]:
    """The names and the values of the group, from a file of entry points."""
    group = ""
    for line in text.splitlines():
        name, assigns, value = line.partition("=")
        if line.startswith("["):
            group = line.strip("[] ")
        elif assigns and group == _GROUP:
            yield name.strip(), value.strip()


@cache
def _others() -> dict[str, Plugin]:
    """Those of other distributions: whoever names one of ours does without."""
    from importlib.metadata import entry_points  # late: 20 ms

    own = _own()
    return {
        point.name: Plugin(
            name=point.name, value=point.value, distribution=point.dist.name if point.dist else None
        )
        for point in entry_points(group=_GROUP)
        if point.name not in own  # to know whose it is takes reading all its metadata
    }

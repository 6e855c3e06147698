"""The options that commands about a whole system share, and the way to the tools that answer them.

The toolkit knows no launch files: `--system` of `ifgen check` and `ifgen breaking` calls the entry points in
the group `ifgen.system`, which `ifgen_tools.system` has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

import click

from ifgen.command_kit.options import EXISTING, EXISTING_FILE, Command
from ifgen.command_kit.tool import ToolError

Transport: TypeAlias = Literal["local", "rclpy", "auto"]


@dataclass(frozen=True, kw_only=True, slots=True)
class SystemRequest:
    """The launch files of a system with their arguments, and where the documents of its nodes are.

    `packages` are in the place of the configured paths; `parameter_files` are for all nodes.
    """

    launch_files: tuple[Path, ...]
    arguments: tuple[tuple[str, str], ...] = ()
    packages: tuple[Path, ...] = ()
    include: tuple[Path, ...] = ()
    parameter_files: tuple[Path, ...] = ()
    transport: Transport = "auto"
    with_python: bool = True
    complete: bool = False
    lock: bool = False


class _PathOrArgument(click.Path):
    """A path that exists, or NAME:=VALUE, which stays a text."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        return value if ":=" in str(value) else EXISTING.convert(value, param, ctx)


PATH_OR_ARGUMENT = _PathOrArgument()


def system_options(command: Command) -> Command:
    """`--system` and the options that belong to it."""
    decorators = (
        click.option("--system", is_flag=True, help="The whole system of the launch files among PATH."),
        click.option(
            "--params",
            "parameter_files",
            metavar="FILE",
            multiple=True,
            type=EXISTING_FILE,
            help="With --system: a parameter file for all nodes; may be repeated.",
        ),
        click.option("--complete", is_flag=True, help="With --system: all nodes must be described and met."),
        click.option("--no-python", is_flag=True, help="With --system: run no launch file in Python."),
        click.option("--lock", is_flag=True, help="With --system: write ifgen.system.lock."),
    )
    for decorate in reversed(decorators):
        command = decorate(command)
    return command


def request(words: Sequence[Path | str], **options: Any) -> SystemRequest:
    """Return a request whose words are launch files, their arguments, packages and parameter files.

    Raises click.UsageError without a launch file.
    """
    arguments = [word.split(":=", 1) for word in words if isinstance(word, str)]
    paths = [word for word in words if isinstance(word, Path)]
    files = tuple(path for path in paths if is_launch_file(path))
    if not files:
        raise click.UsageError("--system needs a launch file among PATH", click.get_current_context())
    parameters = tuple(path for path in paths if path not in files and is_parameter_file(path))
    options["parameter_files"] = (*options.get("parameter_files", ()), *parameters)
    return SystemRequest(
        launch_files=files,
        arguments=tuple((name, value) for name, value in arguments),
        packages=tuple(path for path in paths if path not in {*files, *parameters}),
        **options,
    )


def is_launch_file(path: Path) -> bool:
    """Return whether a path is a launch file, by its name."""
    if path.is_dir():
        return False
    return path.suffix in {".py", ".xml", ".launch"} or (
        path.suffix in {".yaml", ".yml"} and path.stem.endswith("launch")
    )


def is_parameter_file(path: Path) -> bool:
    """Return whether a path is a parameter file, by its name."""
    return path.suffix in {".yaml", ".yml"} and ".nodl" not in path.name and not path.is_dir()


def extension(name: str) -> Callable[..., Any]:
    """Return the function of the tools that answers an option. Raises ToolError where there are none."""
    from importlib.metadata import entry_points  # late: 20 ms

    found = list(entry_points(group="ifgen.system", name=name))
    if not found:
        raise ToolError("the tools for whole systems are not installed", "install ifgen-ros as a whole")
    loaded: Callable[..., Any] = found[0].load()
    return loaded

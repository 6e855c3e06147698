"""The command `ifgen launch`."""

from __future__ import annotations

import importlib
import os
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click
from ifgen.command_kit.options import transport_option
from ifgen.command_kit.system import SystemRequest, extension
from ifgen.command_kit.tool import ToolError, did_you_mean

from ifgen_tools import completion

if TYPE_CHECKING:
    from launch import LaunchDescription, LaunchService

# Late imports: what a launch needs, and `launch` itself, which is found once the transport is chosen.

_TRANSPORTS: dict[str, Literal["local", "rclpy", "auto"]] = {
    "transport:=local": "local",
    "transport:=rclpy": "rclpy",
    "transport:=auto": "auto",
}
"""Arguments that choose the transport, for launch files that declare one of this name."""

_LIBRARIES = ("launch", "launch_ros", "launch_xml", "launch_yaml", "ament_index_python")

_ASSIGNMENT = re.compile(r"(\w+)=(.*)", re.DOTALL)


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: ifgen launch bringup.launch.py rate:=10.0",
)
@transport_option
@click.option(
    "-s", "--show-args", "--show-arguments", is_flag=True, help="Print the arguments, and run nothing."
)
@click.option("-p", "--print", "--print-description", "prints", is_flag=True, help="Print what it contains.")
@click.option("--check", is_flag=True, help="Look for mistakes in what it would start, and run nothing.")
@click.option(
    "-a", "--show-all-subprocesses-output", "show_all", is_flag=True, help="All output on the screen."
)
@click.option(
    "-n", "--noninteractive", is_flag=True, help="Accepted, as in ROS: nobody is ever asked anything."
)
@click.option(
    "--launch-prefix", metavar="COMMAND", default="", help="Put this before the command of processes."
)
@click.option(
    "--launch-prefix-filter", metavar="REGEX", default="", help="Only of executables that match this."
)
@click.argument(
    "words",
    metavar="FILE|PACKAGE FILE [NAME:=VALUE]...",
    nargs=-1,
    required=True,
    shell_complete=completion.words_of_launch,
)
def launch(
    transport: Literal["local", "rclpy", "auto"],
    show_args: bool,
    prints: bool,
    check: bool,
    show_all: bool,
    noninteractive: bool,
    launch_prefix: str,
    launch_prefix_filter: str,
    words: tuple[str, ...],
) -> int:
    """Start what a launch file describes, and end it all together.

    FILE is a launch file of ROS 2 in Python, XML or YAML. With PACKAGE it is one of that package. Each node
    runs in a process of its own. Ctrl-C ends them all.

    The exit code is 0 if every process ended well or was asked to end, 1 for a mistake in the description,
    else the highest exit code of a process that died by itself.
    """
    from ifgen.config.settings import settle

    from ifgen_tools.running import elsewhere

    paths, given = _split(words)
    output = settle().output
    source = click.get_current_context().get_parameter_source("transport")
    if source is not click.core.ParameterSource.COMMANDLINE:
        for word in given:
            transport = _TRANSPORTS.get(word, transport)
    chosen = _put_on_path(transport, output)
    path = _path(paths, output)
    if check:
        arguments = tuple((name, value) for name, _, value in (word.partition(":=") for word in given))
        asked = SystemRequest(launch_files=(Path(path),), arguments=arguments, transport=transport)
        code: int = extension("check")(asked)
        return code
    from ifgen_tools.launching import installed

    if (theirs := installed.folder()) is not None:
        print(f"note: the launch in {theirs} does this", file=sys.stderr, flush=True)
        return installed.run(path, given, output=output, transport=chosen, show_args=show_args, prints=prints)
    _import_ours()
    from launch import LaunchDescription, LaunchService
    from launch._errors import LaunchError, explained
    from launch.actions import IncludeLaunchDescription

    from ifgen_tools.launching.packages import UserPackages

    service = LaunchService(argv=given, noninteractive=noninteractive)
    context = service.context
    context.packages = UserPackages(output, chosen)
    configurations = {"launch-prefix": launch_prefix, "launch-prefix-filter": launch_prefix_filter}
    context.launch_configurations |= {name: value for name, value in configurations.items() if value}
    if show_all:
        os.environ["OVERRIDE_LAUNCH_PROCESS_OUTPUT"] = "both"
    assigned = [word.split(":=", 1) for word in given]
    include = IncludeLaunchDescription(path, launch_arguments=[(name, value) for name, value in assigned])
    include.place = None
    try:
        description = include.launch_description_source.get_launch_description(context)
        if show_args or prints:
            print("\n".join(_described(service, description, path, assigned, show_args=show_args)))
            return 0
    except Exception as error:
        reason = error if isinstance(error, LaunchError) else explained(error)
        raise ToolError(reason.message, reason.help) from error
    for name, _ in assigned:
        if remark := _unknown(name, description, path, service):
            print(f"warning: {remark}", file=sys.stderr, flush=True)
    elsewhere.tell(chosen)
    service.include_launch_description(LaunchDescription([include]))
    service.run()
    return service.exit_code


def _unknown(name: str, description: LaunchDescription, path: str, service: LaunchService) -> str:
    """A remark about an argument that no file declares, and that this one does not mention; else empty."""
    from ifgen_tools.launching.describing import arguments

    known = [argument.name for argument in arguments(description, path, service.context)]
    text = Path(path).read_text(encoding="utf-8", errors="replace")
    if name in {*known, "transport"} or re.search(rf"\b{re.escape(name)}\b", text):
        return ""
    advice = did_you_mean(name, known) or (f"it has {', '.join(known)}" if known else "it has none")
    return f"{path} has no argument '{name}': {advice}"


def _split(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """The file, after its package if there is one, and the arguments for it."""
    given = [word for word in words if ":=" in word]
    paths = [word for word in words if ":=" not in word]
    for word in paths[1:]:
        if found := _ASSIGNMENT.fullmatch(word):
            raise click.UsageError(f"'{word}' sets no argument: write {found[1]}:={found[2]}")
    if len(paths) > 2 or not paths:
        wrong = paths[2] if paths else words[0]
        raise click.UsageError(f"unexpected '{wrong}': arguments are NAME:=VALUE, and FILE comes first")
    for word in given:
        if word.startswith(":="):
            raise click.UsageError(f"the argument '{word}' has no name: arguments are NAME:=VALUE")
    return paths, given


def activate(transport: Literal["local", "rclpy", "auto"], output: Path) -> str:
    """Let launch files find the packages of a transport, and our launch before others; return which one."""
    chosen = _put_on_path(transport, output)
    _import_ours()
    return chosen


def _put_on_path(transport: Literal["local", "rclpy", "auto"], output: Path) -> str:
    from ifgen.activation import ActivationError, put_on_path

    try:
        return put_on_path(transport, output)
    except ActivationError as error:
        raise ToolError(str(error)) from None


def _import_ours() -> None:
    """Import our launch, whatever other folder of that name there is."""
    from ifgen import resources

    sys.path.insert(0, str(resources.libraries()))
    for name in _LIBRARIES:
        importlib.import_module(name)
    sys.path.pop(0)


def _path(paths: list[str], output: Path) -> str:
    """The launch file: as it is named, or in the folders of a package. Raises ToolError."""
    if len(paths) == 1:
        if not Path(paths[0]).is_file():
            raise ToolError(
                f"there is no launch file '{paths[0]}'", "for a file of a package, write its name first"
            )
        return paths[0]
    from ifgen.diagnostics import UsageError

    from ifgen_tools.running import packages

    package, name = paths
    found = packages.find(package, output)
    if found is None:
        raise UsageError([packages.missing(package, output)])
    files = sorted(found.share.rglob("*launch*"))
    matching = [file for file in files if file.name == name and file.is_file()]
    if not matching:
        known = ", ".join(file.name for file in files if file.is_file()) or "none"
        raise ToolError(f"the package '{package}' in {found.share} has no file '{name}'", f"it has {known}")
    if len(matching) > 1:
        raise ToolError(f"the package '{package}' has '{name}' twice: {matching[0]} and {matching[1]}")
    return str(matching[0])


def _described(
    service: LaunchService,
    description: LaunchDescription,
    path: str,
    given: list[list[str]],
    *,
    show_args: bool,
) -> Iterable[str]:
    from launch.launch_introspector import tree

    from ifgen_tools.launching.describing import arguments, arguments_in_words

    service.context.launch_configurations |= dict(given)
    if not show_args:
        return tree(description)
    return arguments_in_words(arguments(description, path, service.context))

"""The verbs of `ifgen interface`."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click

from ifgen_tools import completion, options
from ifgen_tools.group import ToolGroup

# Late imports: each verb loads what it needs.


@click.group(cls=ToolGroup)
def interface() -> None:
    """Look at messages, services and actions that can be found here."""


def _only(command: options.Command) -> options.Command:
    """`-m`, `-s` and `-a`, as `only_msgs`, `only_srvs` and `only_actions`; together they add up."""
    for letter, name, kinds in (
        ("-a", "--only-actions", "actions"),
        ("-s", "--only-srvs", "services"),
        ("-m", "--only-msgs", "messages"),
    ):
        command = click.option(letter, name, is_flag=True, help=f"Only {kinds}.")(command)
    return command


def _include(command: options.Command) -> options.Command:
    """`-I DIR`, as `include`."""
    folder = click.Path(exists=True, file_okay=False, path_type=Path)
    help = "Also look in this folder; may be repeated."
    return click.option("-I", "--include", metavar="DIR", multiple=True, type=folder, help=help)(command)


@interface.command("list", epilog="Example: ifgen interface list --only-actions")
@_only
@_include
@options.json_option
def list_(include: tuple[Path, ...], as_json: bool, **only: bool) -> None:
    """Print the names of all interfaces."""
    from ifgen_tools.interface import finding

    kinds = _kinds(**only)
    found = [each for each in finding.all_types(finding.search_path(include)) if each[0] in kinds]
    if as_json:
        _print_json([name for _, name in found])
        return
    for kind in kinds:
        print(f"{finding.HEADINGS[kind]}:")
        for name in (name for of_kind, name in found if of_kind == kind):
            print(f"    {name}")


@interface.command(epilog="Example: ifgen interface package std_srvs")
@click.argument("package_name", metavar="PACKAGE", shell_complete=completion.packages)
@_only
@_include
@options.json_option
def package(package_name: str, include: tuple[Path, ...], as_json: bool, **only: bool) -> None:
    """Print the names of the interfaces of one package."""
    from ifgen_tools.interface import finding

    kinds = _kinds(**only)
    found = finding.types_of(package_name, finding.search_path(include))
    _print_names((name for kind, name in found if kind in kinds), as_json)


@interface.command(epilog="Example: ifgen interface packages --only-actions")
@_only
@_include
@options.json_option
def packages(include: tuple[Path, ...], as_json: bool, **only: bool) -> None:
    """Print the names of the packages that have interfaces."""
    from ifgen_tools.interface import finding

    _print_names(finding.packages_with(_kinds(**only), finding.search_path(include)), as_json)


@interface.command(epilog="Example: ifgen interface show geometry_msgs/msg/PoseStamped")
@click.argument("type_", metavar="TYPE", shell_complete=completion.types)
@click.option("--all-comments", is_flag=True, help="The comments of nested messages as well.")
@click.option("--no-comments", is_flag=True, help="No comments, and no blank lines.")
@_include
@click.option("--json", "as_json", is_flag=True, help="Print the type description of ROS instead.")
def show(type_: str, all_comments: bool, no_comments: bool, include: tuple[Path, ...], as_json: bool) -> None:
    """Print the definition of an interface.

    The definition of a nested message is below its field. A TYPE of `-` is read from a pipe, as in
    `ifgen topic type /chatter | ifgen interface show -`.
    """
    from ifgen_tools.interface import finding
    from ifgen_tools.interface.show import shown

    if all_comments and no_comments:
        raise click.UsageError("--all-comments and --no-comments exclude each other")
    described, registry = finding.find(_from_pipe(type_), finding.search_path(include))
    if as_json:
        from ifgen.definition.type_description import describe

        _print_json(describe(described, registry))
        return
    for line in shown(described, registry, "all" if all_comments else "none" if no_comments else "own"):
        print(line)


@interface.command(epilog="Example: ifgen interface proto geometry_msgs/msg/Point --no-quotes")
@click.argument("type_", metavar="TYPE", shell_complete=completion.types)
@click.option("--no-quotes", is_flag=True, help="Without quotes around the whole.")
@options.transport_option
@options.json_option
def proto(type_: str, no_quotes: bool, transport: Any, as_json: bool) -> None:
    """Print the fields and default values of an interface, as YAML to copy and change.

    That is a message, the request of a service, or the goal of an action.
    """
    from ifgen_tools.interface.proto import prototype
    from ifgen_tools.texts.formats import Style, as_yaml, plain

    message = prototype(type_, transport)
    if as_json:
        _print_json(plain(message, Style()))
        return
    text = as_yaml(message)
    print(text if no_quotes else f'"{text}"')


def _from_pipe(name: str) -> str:
    if name != "-":
        return name
    if sys.stdin.isatty():
        raise click.UsageError("'-' stands for a pipe, and stdin is a terminal")
    name = sys.stdin.readline().strip()
    if not name:
        raise click.UsageError("'-' stands for a pipe, and nothing came through it")
    return name


def _kinds(only_msgs: bool, only_srvs: bool, only_actions: bool) -> list[str]:
    """The kinds that were asked for: all if none was."""
    asked = {"msg": only_msgs, "srv": only_srvs, "action": only_actions}
    return [kind for kind, wanted in asked.items() if wanted] or list(asked)


def _print_names(names: Iterable[str], as_json: bool) -> None:
    if as_json:
        _print_json(list(names))
        return
    for name in names:
        print(name)


def _print_json(value: object) -> None:
    print(json.dumps(value, indent=2))

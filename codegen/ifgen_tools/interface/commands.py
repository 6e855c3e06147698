"""The verbs of `ifgen interface`."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click
from ifgen.command_kit import completion, options
from ifgen.command_kit.tool import ToolError, ToolGroup, did_you_mean

from ifgen_tools.verbs import TransportChoice

if TYPE_CHECKING:
    from ifgen.reading.search_path import SearchPath

# Late imports: each verb loads what it needs.

_HEADINGS: Final = {"msg": "Messages", "srv": "Services", "action": "Actions"}


@click.group(cls=ToolGroup)
def interface() -> None:
    """Look at messages, services and actions."""


def _only(command: options.Command) -> options.Command:
    """`-m`, `-s` and `-a`, as `only_msgs`, `only_srvs` and `only_actions`; together they add up."""
    for letter, name, kinds in (
        ("-a", "--only-actions", "actions"),
        ("-s", "--only-srvs", "services"),
        ("-m", "--only-msgs", "messages"),
    ):
        command = click.option(letter, name, is_flag=True, help=f"Only {kinds}.")(command)
    return command


@interface.command("list", epilog="Example: ifgen interface list --only-actions")
@_only
@options.include_option
@options.json_option
def list_(include: tuple[Path, ...], as_json: bool, **only: bool) -> None:
    """Print the names of all interfaces."""
    from ifgen.pipeline.lookup import search_path

    kinds, search = _kinds(**only), search_path(include)
    names = {package: _types_in(package, search) for package in search.package_names()}
    if as_json:
        _print_json([name for types in names.values() for kind, name in types if kind in kinds])
        return
    for kind in kinds:
        print(f"{_HEADINGS[kind]}:")
        for types in names.values():
            print("".join(f"    {name}\n" for of_kind, name in types if of_kind == kind), end="")


@interface.command(epilog="Example: ifgen interface package std_srvs")
@click.argument("package_name", metavar="PACKAGE", shell_complete=completion.packages)
@_only
@options.include_option
@options.json_option
def package(package_name: str, include: tuple[Path, ...], as_json: bool, **only: bool) -> None:
    """Print the names of the interfaces of one package."""
    from ifgen.pipeline.lookup import search_path

    kinds, types = _kinds(**only), _types_in(package_name, search_path(include))
    _print_names((name for kind, name in types if kind in kinds), as_json)


@interface.command(epilog="Example: ifgen interface packages --only-actions")
@_only
@options.include_option
@options.json_option
def packages(include: tuple[Path, ...], as_json: bool, **only: bool) -> None:
    """Print the names of the packages that have interfaces."""
    from ifgen.pipeline.lookup import search_path

    kinds, search = _kinds(**only), search_path(include)
    there = (p for p in search.package_names() if any(kind in kinds for kind, _ in _types_in(p, search)))
    _print_names(there, as_json)


@interface.command(epilog="Example: ifgen interface show geometry_msgs/msg/PoseStamped")
@click.argument("type_", metavar="TYPE", shell_complete=completion.types)
@click.option("--all-comments", is_flag=True, help="The comments of nested messages as well.")
@click.option("--no-comments", is_flag=True, help="No comments, and no blank lines.")
@options.include_option
@click.option("--json", "as_json", is_flag=True, help="Print the type description of ROS instead.")
def show(type_: str, all_comments: bool, no_comments: bool, include: tuple[Path, ...], as_json: bool) -> None:
    """Print the definition of an interface.

    The definition of a nested message is below its field. A TYPE of `-` is read from a pipe, as in
    `ifgen topic type /chatter | ifgen interface show -`.
    """
    from ifgen.diagnostics import UsageError
    from ifgen.pipeline.lookup import find_type, search_path

    from ifgen_tools.interface.definitions import shown

    if all_comments and no_comments:
        raise click.UsageError("--all-comments and --no-comments exclude each other")
    try:
        described, registry = find_type(_from_pipe(type_), search_path(include))
    except UsageError as error:
        first = error.diagnostics[0]
        raise ToolError(first.message, first.help or "") from None
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
def proto(type_: str, no_quotes: bool, transport: TransportChoice, as_json: bool) -> None:
    """Print the fields and default values of an interface, as YAML to copy and change.

    That is a message, the request of a service, or the goal of an action.
    """
    from ifgen_tools.session import activate
    from ifgen_tools.texts.formats import as_yaml, plain
    from ifgen_tools.texts.style import WHOLE
    from ifgen_tools.types import interface_class

    activate(transport)
    folder = type_.split("/")[1] if type_.count("/") == 2 else "msg"
    cls = interface_class(type_, folder if folder in {"srv", "action"} else "msg")
    part = {"srv": "Request", "action": "Goal"}.get(folder)
    message = getattr(cls, part)() if part else cls()
    if as_json:
        _print_json(plain(message, WHOLE))
        return
    text = as_yaml(message)
    print(text if no_quotes else f'"{text}"')


def _types_in(package_name: str, search: SearchPath) -> list[tuple[str, str]]:
    """Kind and name of the types in a package, sorted by name. ToolError if there is no such package."""
    package = search.package(package_name)
    files = package.known_files() if package else []
    if not files:
        near = did_you_mean(package_name, search.package_names())
        raise ToolError(f"unknown package {package_name!r}", near or "see `ifgen interface packages`")
    pairs = {(file.folder, f"{package_name}/{file.folder}/{file.name}") for file in files}
    return sorted(pairs, key=lambda pair: pair[1])


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

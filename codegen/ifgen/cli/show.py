"""The commands `ifgen show` and `ifgen hash`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from ifgen.command_kit import completion, terminal
from ifgen.command_kit.options import include_option

# Late imports: `ifgen --help` loads this module, and does without the compiler.


@click.command(epilog="Example: ifgen show geometry_msgs/msg/Pose")
@click.argument("type_", metavar="TYPE|PACKAGE", shell_complete=completion.types_and_packages)
@include_option
@click.option("--json", "as_json", is_flag=True, help="Print the ROS type description instead.")
def show(type_: str, include: tuple[Path, ...], as_json: bool) -> int:
    """Print an interface with its nested types and its type hash.

    TYPE is a name such as geometry_msgs/msg/Pose, or Pose if only one type has that name. For a PACKAGE, it
    lists the names of its types.
    """
    from ifgen.pipeline import lookup

    search = lookup.search_path(include)
    if names := lookup.types_in(type_, search):
        if as_json:
            message = f"--json describes one TYPE, and {type_} is a package"
            raise click.UsageError(message, click.get_current_context())
        print("\n".join(names))
        return 0
    described, registry = lookup.find_type(type_, search)
    if as_json:
        from ifgen.definition.type_description import describe

        print(json.dumps(describe(described, registry), indent=2))
    else:
        from ifgen.cli import interface_text

        print("\n".join(interface_text.lines(described, registry)))
    return 0


@click.command("hash", epilog="Example: ifgen hash std_srvs/srv/Trigger")
@click.argument("names", metavar="[TYPE|PACKAGE]...", nargs=-1, shell_complete=completion.types_and_packages)
@include_option
def hashes(names: tuple[str, ...], include: tuple[Path, ...]) -> int:
    """Print type hashes, including those of derived types.

    TYPE is a name such as std_msgs/msg/String, PACKAGE one such as std_msgs. The default is every type that
    ifgen finds. If some types have no hash, because of mistakes, it reports them at the end and exits with 1.
    """
    from ifgen.definition.type_description import type_hash
    from ifgen.pipeline import lookup

    search = lookup.search_path(include)
    described, registry, errors = lookup.find_what_can_be(names or search.package_names(), search)
    for interface in described:
        print(f"{interface.type_name} {type_hash(interface, registry)}")
    terminal.print_diagnostics(errors, stderr=True)
    return int(bool(errors))

"""`ifgen policy` and `ifgen admit`: who may do what in a system, and who may join it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from ifgen.command_kit.options import EXISTING_FILE, OUTPUT_FILE, include_option, transport_option
from ifgen.command_kit.system import PATH_OR_ARGUMENT, request
from ifgen.diagnostics import Diagnostic, InputError, UsageError

if TYPE_CHECKING:
    from ifgen_tools.policy.grants import Grants
    from ifgen_tools.policy.zenoh import Identity
    from ifgen_tools.verbs import TransportChoice

# Late imports: each command loads what it needs, so that the others start fast.

_DOMAINS = 233
"""Domains of ROS: 0 to 232."""


def _options(command: Callable[..., int]) -> Callable[..., int]:
    decorators = (
        click.argument(
            "words",
            metavar="LAUNCH_FILE [NAME:=VALUE|PACKAGE]...",
            nargs=-1,
            required=True,
            type=PATH_OR_ARGUMENT,
        ),
        click.option("--no-python", is_flag=True, help="Run no launch file in Python."),
        include_option,
        transport_option,
    )
    for decorate in reversed(decorators):
        command = decorate(command)
    return command


_output = click.option("-o", "--output", metavar="FILE", type=OUTPUT_FILE, help="Write into this file.")
_domain = click.option(
    "--domain", type=click.IntRange(0, _DOMAINS - 1), help="The domain; default: ROS_DOMAIN_ID, or 0."
)


@click.group()
def policy() -> None:
    """Write which node may do what.

    That is exactly what the documents of the nodes of launch files declare. The names are those after
    remapping. Nodes without a document may do nothing.
    """


@policy.command(epilog="Example: ifgen policy sros2 bringup.launch.py rate:=5 -o policy.xml")
@_options
@_output
def sros2(output: Path | None, **options: Any) -> int:
    """Write the policy.xml of SROS 2, with an enclave for each node or for each `--enclave`."""
    from ifgen_tools.policy import sros2 as form

    return _write(form.text(_grants(**options)), output)


@policy.command(epilog="Example: ifgen policy router bringup.launch.py rate:=5 -o router.json5")
@_options
@_output
@_domain
@click.option(
    "--by",
    "identity",
    type=click.Choice(["certificates", "users"]),
    default="certificates",
    show_default=True,
    help="How programs show who they are: by the common name of a certificate, or by a user's name.",
)
def router(output: Path | None, domain: int | None, identity: Identity, **options: Any) -> int:
    """Write the configuration of a Zenoh router that keeps each node to its rights.

    For `ifgen router --config FILE` or rmw_zenohd. A program is known by its enclave: the full name of its
    node, or what `--enclave` says.
    """
    from ifgen_tools.policy import zenoh

    return _write(_as_json(zenoh.router(_grants(**options), _domain_of(domain), identity)), output)


@policy.command(epilog="Example: ifgen policy zenoh bringup.launch.py rate:=5 -o sessions")
@_options
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(file_okay=False, path_type=Path),
    required=True,
    help="Write ENCLAVE.json5 here.",
)
@_domain
def zenoh(output: Path, domain: int | None, **options: Any) -> int:
    """Write a configuration for the Zenoh session of each program, which holds back what it may not do.

    Put its keys into the file of ZENOH_SESSION_CONFIG_URI. It protects a program from others, and others from
    its mistakes; only a router protects them from a program that ignores it.
    """
    from ifgen_tools.policy import zenoh as form

    files = {
        output / f"{enclave.strip('/').replace('/', '.') or 'root'}.json5": content
        for enclave, content in form.sessions(_grants(**options), _domain_of(domain)).items()
    }
    output.mkdir(parents=True, exist_ok=True)
    for path, content in files.items():
        _write(_as_json(content), path)
    return 0


@click.command(epilog="Example: ifgen admit arm.lock --against robot.lock")
@click.argument("manifest", type=EXISTING_FILE)
@click.option(
    "--against",
    metavar="RUNNING|MANIFEST",
    required=True,
    help="The word `running`, for what runs, or a manifest.",
)
@click.option("--complete", is_flag=True, help="Nobody else will come: whatever is needed must be there.")
@click.option("--format", "format_", type=click.Choice(["text", "json"]), default="text", help="Output form.")
@transport_option
def admit(manifest: Path, against: str, complete: bool, format_: str, transport: TransportChoice) -> int:
    """Say whether nodes may join a system, and why not.

    The nodes are those of a manifest. The exit code is 0 if they may, 1 if not, and 2 if nobody can tell, as
    where documents or definitions are missing. `ifgen check --system FILE --lock` writes manifests.
    """
    from ifgen_tools.policy import admission
    from ifgen_tools.system import manifest as manifests

    try:
        candidate = manifests.read(manifest)
        if against == "running":
            system = admission.running(transport)
        elif Path(against).is_file():
            system = admission.described(manifests.read(Path(against)))
        else:
            help = "write `running`, or the path of a manifest"
            raise UsageError([Diagnostic("no-path", f"there is no file {against}", help=help)])
    except InputError as error:
        raise UsageError(error.diagnostics) from None
    verdict = admission.judge(candidate, system, complete=complete)
    click.echo(json.dumps(verdict.as_json(), indent=2) if format_ == "json" else verdict.as_text())
    return verdict.code


def _grants(
    words: tuple[Path | str, ...], no_python: bool, include: tuple[Path, ...], transport: TransportChoice
) -> list[Grants]:
    """The grants of the nodes of launch files. Raises InputError if their documents are wrong."""
    from ifgen_tools.policy.grants import of_system
    from ifgen_tools.system.commands import of_request

    built = of_request(request(words, include=include, transport=transport, with_python=not no_python))
    errors = [each for each in built.findings if each.severity == "error"]
    if errors:
        raise InputError(errors)
    for node in built.system.open_ends:
        click.echo(f"warning: {node.name} has no document, so it may do nothing", err=True)
    found = of_system(built.system, built.registry)
    if not found:
        click.echo("warning: no node of these launch files has a document: nobody may do anything", err=True)
    return found


def _domain_of(chosen: int | None) -> int:
    """The domain that was asked for, else that of the environment, which the transport has checked."""
    return int(os.environ.get("ROS_DOMAIN_ID") or 0) if chosen is None else chosen


def _as_json(content: Any) -> str:
    return json.dumps(content, indent=2) + "\n"


def _write(text: str, output: Path | None) -> int:
    if output is None:
        click.echo(text, nl=False)
    else:
        output.write_text(text, encoding="utf-8")
        click.echo(f"{output}: written")
    return 0

"""`ifgen doctor`: what this machine has, and how to get the rest; or what is wrong with a graph."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource
from ifgen.command_kit import terminal
from ifgen.command_kit.options import format_option, include_option
from ifgen.command_kit.system import extension
from ifgen.config.settings import settle

if TYPE_CHECKING:
    from ifgen_tools.verbs import TransportChoice

# Late imports: looking at this machine and looking at a graph have nothing in common.


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]}, epilog="Example: ifgen doctor --graph"
)
@click.option("--graph", is_flag=True, help="Look at running nodes instead: whose definitions differ?")
@click.option(
    "--run",
    "programs",
    metavar="PROGRAM",
    multiple=True,
    help="With --graph: run this program meanwhile: 'talker.py', '-m package.node'; may be repeated.",
)
@click.option(
    "--transport",
    type=click.Choice(["local", "rclpy", "auto"]),
    envvar="IFGEN_TRANSPORT",
    help="With --graph: where to look, as for `ifgen graph`.",
)
@include_option
@format_option
def doctor(
    graph: bool,
    programs: tuple[str, ...],
    transport: TransportChoice | None,
    include: tuple[Path, ...],
    format_: str,
) -> int:
    """Report what this machine has, and how to install the rest.

    With --graph, look at a running system, and report each topic, service and action whose nodes have
    different definitions of its type, with what differs. Exits with 1 if there is one.
    """
    if graph:
        return _graph_doctor(programs, transport or "auto", include, format_)
    from ifgen_tools.doctor import machine

    context = click.get_current_context()
    is_named = context.get_parameter_source("transport") is ParameterSource.COMMANDLINE
    if programs or is_named or include or format_ != "text":
        raise click.UsageError("These options need --graph", context)
    for finding in list(machine.examine()):  # all at once: some take a while
        print(f"{finding.subject + ':':17}{finding.found}")
        if finding.advice:
            print(f"{'':17}-> {finding.advice}")
    return 0


def _graph_doctor(
    programs: tuple[str, ...], transport: TransportChoice, include: tuple[Path, ...], format_: str
) -> int:
    import shlex

    from ifgen_tools.beside import session_beside
    from ifgen_tools.doctor import findings
    from ifgen_tools.running import run as running

    words = [running.split(shlex.split(program))[0] for program in programs]
    with session_beside(words, transport) as session:
        seen = findings.look(session)
        graph = session.graph()
    different = list(findings.findings(seen, include))
    others = settle().policy.told(extension("running")(graph))
    agreed = f"{terminal.counted(len(seen.nodes), 'node')}: all definitions agree"
    if others and not different and format_ == "text":
        print(f"{agreed}\n")
    return terminal.print_findings([*different, *others], format_, agreed)

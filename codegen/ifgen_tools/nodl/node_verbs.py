"""Verbs of `ifgen nodl` that look at a running node."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click
from ifgen.command_kit.options import (
    EXISTING_FILE,
    OUTPUT_FILE,
    format_option,
    include_option,
    strict_option,
    transport_option,
)
from ifgen.diagnostics import Diagnostic, UsageError

from ifgen_tools.nodl.printing import show

if TYPE_CHECKING:
    from ifgen_tools.session import Session
    from ifgen_tools.verbs import TransportChoice

# Late imports: each command loads what it needs, so that the others start fast.

_PROGRAMS = "ifgen.programs"


class _WithPrograms(click.Command):
    """A command that leaves all arguments after `--` to the programs that it runs."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        at = args.index("--") if "--" in args else len(args)
        ctx.meta[_PROGRAMS] = args[at + 1 :]
        return super().parse_args(ctx, args[:at])


@click.command(
    cls=_WithPrograms,
    options_metavar="[OPTIONS]",
    epilog="Example: ifgen nodl describe /talker -o talker.nodl.yaml -- talker.py",
)
@click.argument("node", metavar="[NODE] [-- PROGRAM [ARGS]...]", required=False)
@click.option(
    "-o", "--output", metavar="FILE", type=OUTPUT_FILE, help="Write into this file, .yaml or .json."
)
@click.option("--force", is_flag=True, help="Replace FILE if it exists.")
@click.option(
    "--from",
    "message",
    metavar="MESSAGE",
    type=EXISTING_FILE,
    help="Describe the node in this file: one rosgraph_msgs/msg/Node in YAML or in a bag.",
)
@click.option("--topic", help="Describe the node in the rosgraph_msgs/msg/Node on this topic.")
@transport_option
@click.pass_context
def describe(
    context: click.Context,
    node: str | None,
    output: Path | None,
    force: bool,
    message: Path | None,
    topic: str | None,
    transport: TransportChoice,
) -> int:
    """Write the description of a running node.

    NODE is its name, which you can leave out if there is only one. PROGRAM is run first, as by `ifgen run`,
    with `:` between several programs.
    """
    from ifgen_tools.beside import session_beside
    from ifgen_tools.nodl.document import as_json, as_yaml, document_of
    from ifgen_tools.nodl.observation import node_from, read_node
    from ifgen_tools.nodl.parameters import parameters_of
    from ifgen_tools.ros_graph import View
    from ifgen_tools.running import run

    if output is not None and output.exists() and not force:
        raise UsageError([Diagnostic("existing-file", f"{output} exists", help="replace it with --force")])
    words: list[str] = context.meta[_PROGRAMS]
    if message is not None or topic is not None:
        if message is None:
            with session_beside(run.split(words) if words else [], transport) as session:
                chosen, ends, parameters = node_from(_message_on(session, topic or ""))
        else:
            chosen, ends, parameters = read_node(message)
        seen = View((chosen,), tuple(ends)).of_authors().endpoints
        document, omitted = document_of(chosen, seen, parameters)
    else:
        with session_beside(run.split(words) if words else [], transport) as session:
            view = session.graph().of_authors()
            found = choose(view.nodes, node)
            if found is None:
                raise UsageError([_unclear(view.nodes, node)])
            chosen = found
            document, omitted = document_of(chosen, view.endpoints, parameters_of(session, chosen))
    write = as_json if output is not None and output.suffix == ".json" else as_yaml
    text = write(document, omitted)
    if output is None:
        click.echo(text, nl=False)
        return 0
    output.write_text(text, encoding="utf-8")
    click.echo(f"{output}: node {chosen}")
    for reason in omitted:
        click.echo(f"warning: left out: {reason}", err=True)
    return 0


@click.command(
    cls=_WithPrograms,
    options_metavar="[OPTIONS]",
    epilog="Example: ifgen nodl conform /patrol --file nodl/patrol.nodl.yaml -- patrol.py",
)
@click.argument("node", metavar="[NODE] [-- PROGRAM [ARGS]...]", required=False)
@click.option("--file", "file", metavar="FILE", type=EXISTING_FILE, required=True, help="The document.")
@click.option("--timeout", type=float, default=15.0, show_default=True, help="Seconds to wait for the node.")
@click.option(
    "--ignore",
    metavar="RULE",
    multiple=True,
    help="KIND:NAME[:TYPE] of what the node may have beyond its document, with * and ?; may be repeated.",
)
@click.option("--compatible", is_flag=True, help="Take QoS that can meet for equal.")
@click.option("--no-defaults", is_flag=True, help="Do not compare values of parameters with their defaults.")
@click.option(
    "-r", "--remap", "remaps", metavar="FROM:=TO", multiple=True, help="How the node was started; repeatable."
)
@click.option("--launch", "launch_file", type=EXISTING_FILE, help="Take the remaps from this launch file.")
@strict_option
@include_option
@format_option
@transport_option
@click.pass_context
def conform(
    context: click.Context,
    node: str | None,
    file: Path,
    timeout: float,
    ignore: tuple[str, ...],
    compatible: bool,
    no_defaults: bool,
    remaps: tuple[str, ...],
    launch_file: Path | None,
    strict: bool | None,
    include: tuple[Path, ...],
    format_: str,
    transport: TransportChoice,
) -> int:
    """Compare a running node with its document.

    NODE is its name, which you can leave out if there is only one. PROGRAM is run first, as by `ifgen run`.
    What the middleware does not tell is `unverifiable`, which is no failure without --strict. The variable
    NODL_CONFORMANCE_IGNORE has further rules for --ignore, with blanks between them.
    """
    import os

    from ifgen_tools.beside import session_beside
    from ifgen_tools.nodl import contract
    from ifgen_tools.nodl.conformance import Choices
    from ifgen_tools.running import run

    document = contract.read(file, include)
    rules = (*ignore, *os.environ.get("NODL_CONFORMANCE_IGNORE", "").split())
    choices = Choices(compatible, not no_defaults, rules)
    given = contract.remaps_of(remaps)
    words: list[str] = context.meta[_PROGRAMS]
    with session_beside(run.split(words) if words else [], transport) as session:
        session.wait_for(lambda: choose(session.graph().visible().nodes, node) is not None, timeout)
        nodes = session.graph().visible().nodes
        chosen = choose(nodes, node)
        if chosen is None:
            raise UsageError([_unclear(nodes, node)])
        if launch_file is not None:
            given += contract.remaps_of_launch(launch_file, chosen, session.transport)
        report = contract.check(session, chosen, document, choices, given)
    return show(report, format_, f"{chosen}: conforms", strict=bool(strict))


@click.command(
    cls=_WithPrograms,
    options_metavar="[OPTIONS]",
    epilog="Example: ifgen nodl observe /talker -o talker.mcap -- talker.py",
)
@click.argument("node", metavar="[NODE] [-- PROGRAM [ARGS]...]", required=False)
@click.option("-o", "--output", metavar="FILE", type=OUTPUT_FILE, help="Write the message: .yaml or .mcap.")
@click.option("--all", "whole", is_flag=True, help="A rosgraph_msgs/msg/Graph of all nodes instead.")
@click.option("--topic", help="Where to publish; default: /nodl/observed_node, or /nodl/observed_graph.")
@click.option("--no-parameters", is_flag=True, help="Do not ask the nodes for their parameters.")
@click.option("--spin-seconds", type=float, help="End after this time; default: at Ctrl-C.")
@transport_option
@click.pass_context
def observe(
    context: click.Context,
    node: str | None,
    output: Path | None,
    whole: bool,
    topic: str | None,
    no_parameters: bool,
    spin_seconds: float | None,
    transport: TransportChoice,
) -> int:
    """Publish what can be seen of a node as a rosgraph_msgs/msg/Node, as nodl_observe does.

    The message has everything, what the framework makes included. Late subscriptions get it, too. NODE and
    PROGRAM are those of `ifgen nodl describe`.
    """
    from ifgen_tools.beside import session_beside
    from ifgen_tools.nodl import observation
    from ifgen_tools.nodl.parameters import described_parameters
    from ifgen_tools.running import run

    words: list[str] = context.meta[_PROGRAMS]
    asked = (lambda *_: None) if no_parameters else described_parameters
    with session_beside(run.split(words) if words else [], transport) as session:
        view = session.graph()
        visible = view.visible().nodes
        chosen = choose(visible, node)
        if chosen is None and not whole:
            raise UsageError([_unclear(visible, node)])
        names = visible if whole else (chosen or "",)
        messages = [observation.node_message(each, view, asked(session, each)) for each in names]
        message = observation.graph_message(messages) if whole else messages[0]
        place = topic or (observation.GRAPH_TOPIC if whole else observation.TOPIC)
        click.echo(f"{output or place}: {', '.join(names)}")
        if output is not None:
            observation.write(message, place, output)
            return 0
        publisher = session.node.create_publisher(type(message), place, observation.latched())
        publisher.publish(message)
        session.wait_for(lambda: False, spin_seconds)
    return 0


def _message_on(session: Session, topic: str) -> object:
    """The first message about a node on a topic. Raises UsageError if none comes."""
    from ifgen_tools.nodl import observation

    got: list[object] = []
    subscription = session.node.create_subscription(
        observation.message_class("Node"), topic, got.append, observation.latched()
    )
    try:
        if not session.wait_for(lambda: bool(got), 15.0):
            message = f"nobody published a node on {topic} within 15 s"
            raise UsageError([Diagnostic("no-node", message, help="run `ifgen nodl observe NODE`")])
    finally:
        session.node.destroy_subscription(subscription)
    return got[0]


def choose(nodes: Sequence[str], wanted: str | None) -> str | None:
    """The full name of the node that was asked for, or of the only one; None if it is not clear which."""
    if wanted is None:
        found = list(nodes)
    else:
        found = [name for name in nodes if name == wanted or name.rpartition("/")[2] == wanted]
    return found[0] if len(found) == 1 else None


def _unclear(nodes: Sequence[str], wanted: str | None) -> Diagnostic:
    if not nodes:
        advice = "name a program after `--`, such as `ifgen nodl describe -- talker.py`"
        return Diagnostic("no-node", "no running node was found", help=advice)
    listed = ", ".join(sorted(nodes))
    if wanted is None:
        return Diagnostic("no-node", f"there are {len(nodes)} nodes", help=f"name one of them: {listed}")
    several = sum(name.rpartition("/")[2] == wanted for name in nodes) > 1
    message = f"there {'are several nodes' if several else 'is no node'} '{wanted}'"
    return Diagnostic("no-node", message, help=f"the nodes are {listed}")


VERBS = (describe, observe, conform)

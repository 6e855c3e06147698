"""`ifgen nodl`: descriptions of nodes that run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click
from ifgen.command_kit.options import OUTPUT_FILE, transport_option
from ifgen.diagnostics import Diagnostic, UsageError

if TYPE_CHECKING:
    from ifgen_tools.verbs import TransportChoice

# Late imports: each command loads what it needs, so that the others start fast.

_PROGRAMS = "ifgen.programs"


class _WithPrograms(click.Command):
    """A command that leaves all arguments after `--` to the programs that it runs."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        at = args.index("--") if "--" in args else len(args)
        ctx.meta[_PROGRAMS] = args[at + 1 :]
        return super().parse_args(ctx, args[:at])


@click.group()
def nodl() -> None:
    """Work with node descriptions in NoDL.

    `ifgen check` looks for mistakes in them, and `ifgen generate` makes packages from them.
    """


@nodl.command(
    cls=_WithPrograms,
    options_metavar="[OPTIONS]",
    epilog="Example: ifgen nodl describe /talker -o talker.nodl.yaml -- talker.py",
)
@click.argument("node", metavar="[NODE] [-- PROGRAM [ARGS]...]", required=False)
@click.option(
    "-o", "--output", metavar="FILE", type=OUTPUT_FILE, help="Write into this file, .yaml or .json."
)
@click.option("--force", is_flag=True, help="Replace FILE if it exists.")
@transport_option
@click.pass_context
def describe(
    context: click.Context,
    node: str | None,
    output: Path | None,
    force: bool,
    transport: TransportChoice,
) -> int:
    """Write the description of a running node.

    NODE is its name, which you can leave out if there is only one. PROGRAM is run first, as by `ifgen run`,
    with `:` between several programs.
    """
    from ifgen_tools.beside import session_beside
    from ifgen_tools.nodl.document import as_json, as_yaml, document_of
    from ifgen_tools.nodl.parameters import parameters_of
    from ifgen_tools.running import run

    if output is not None and output.exists() and not force:
        raise UsageError([Diagnostic("existing-file", f"{output} exists", help="replace it with --force")])
    words: list[str] = context.meta[_PROGRAMS]
    with session_beside(run.split(words) if words else [], transport) as session:
        view = session.graph().of_authors()
        chosen = choose(view.nodes, node)
        if chosen is None:
            raise UsageError([_unclear(view.nodes, node)])
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


@nodl.command(epilog="Example: ifgen nodl schema > nodl.schema.json")
def schema() -> int:
    """Print the JSON schema of NoDL, for editors.

    With this line in a description, an editor with yaml-language-server completes it and marks mistakes:

    \b
    # yaml-language-server: $schema=nodl.schema.json
    """  # noqa: D301 - the backspace is for click, which keeps the line after it as it is
    import json

    from ifgen.nodl.schema import schema as of_documents

    click.echo(json.dumps(of_documents(), indent=2))
    return 0


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

"""`ifgen nodl`: documents of nodes, and what they say of nodes that run."""

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
    quiet_option,
    strict_option,
    transport_option,
)
from ifgen.diagnostics import Diagnostic, InputError, UsageError

if TYPE_CHECKING:
    from ifgen_tools.nodl.conformance import Report
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
@click.option(
    "--from",
    "message",
    metavar="MESSAGE",
    type=EXISTING_FILE,
    help="Describe the node in this file: one rosgraph_msgs/msg/Node in YAML.",
)
@transport_option
@click.pass_context
def describe(
    context: click.Context,
    node: str | None,
    output: Path | None,
    force: bool,
    message: Path | None,
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
    if message is not None:
        from ifgen_tools.nodl.rosgraph import read_node
        from ifgen_tools.ros_graph import View

        chosen, ends, parameters = read_node(message)
        document, omitted = document_of(
            chosen, View((chosen,), tuple(ends)).of_authors().endpoints, parameters
        )
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


@nodl.command(epilog="Example: ifgen nodl validate nodl/*.nodl.yaml")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=EXISTING_FILE)
@click.option("--no-resolve", is_flag=True, help="Look at the documents alone, and not at their includes.")
@include_option
@strict_option
@quiet_option
@format_option
def validate(
    files: tuple[Path, ...],
    no_resolve: bool,
    include: tuple[Path, ...],
    strict: bool | None,
    quiet: bool,
    format_: str,
) -> int:
    """Check documents by the rules of NoDL, as `ros2 nodl validate` does.

    What ifgen needs beyond those rules to generate code, such as interfaces that exist, gives warnings. They
    are errors with --strict, and in `ifgen check`.
    """
    from ifgen.command_kit import terminal
    from ifgen.nodl.verdict import verdict
    from ifgen.reading.search_path import SearchPath

    search = SearchPath((), include)
    found: list[Diagnostic] = []
    valid: list[str] = []
    for file in files:
        judged = verdict(file, search, follow=not no_resolve, strict=bool(strict))
        found += (*judged.errors, *judged.warnings)
        if not judged.errors:
            valid.append(f"{file}: ok")
    if format_ == "text" and not quiet:
        for line in valid:
            click.echo(line)
    return terminal.print_findings(list(dict.fromkeys(found)), format_, "")


@nodl.command(epilog="Example: ifgen nodl diff nodl/talker.nodl.yaml described.nodl.yaml")
@click.argument("expected", type=EXISTING_FILE)
@click.argument("actual", type=EXISTING_FILE)
@click.option("--node-name", metavar="NODE", default="/node", help="Full name of the node; default: /node.")
@click.option("--compatible", is_flag=True, help="Take QoS that can meet for equal.")
@include_option
@format_option
def diff(
    expected: Path, actual: Path, node_name: str, compatible: bool, include: tuple[Path, ...], format_: str
) -> int:
    """Compare what two documents say, with all that they include.

    The exit code is 0 if they say the same, 1 if not, and 2 if one of them cannot be read.
    """
    from ifgen_tools.nodl import contract
    from ifgen_tools.nodl.conformance import Choices, compare

    try:
        first, second = (contract.read(path, include).side(node_name) for path in (expected, actual))
    except InputError as error:
        raise UsageError(error.diagnostics) from None
    report = compare(first, second, Choices(compatible))
    return show(report, format_, f"{expected} and {actual} say the same")


@nodl.command(
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


def show(report: Report, format_: str, if_none: str, *, strict: bool = False) -> int:
    """Print differences as text, JSON or annotations; the exit code is 1 if there are certain ones."""
    import json

    failed = bool(report.differences if strict else report.failures)
    if format_ == "github":
        from ifgen.command_kit.report import as_github_annotations

        from ifgen_tools.nodl.conformance import diagnostics

        click.echo(as_github_annotations(diagnostics(report)))
    elif format_ == "json":
        groups = {"differences": report.differences, "ignored": report.ignored}
        listed = {
            name: [
                {"kind": each.kind, "section": each.section, "name": each.name, "detail": each.detail}
                for each in group
            ]
            for name, group in groups.items()
        }
        click.echo(json.dumps({"conforms": not failed, **listed}, indent=2, ensure_ascii=False))
    else:
        for each in report.differences:
            click.echo(str(each))
        if not failed:
            click.echo(if_none)
        for each in report.ignored:
            click.echo(f"ignored: {each}")
    return 1 if failed else 0


@nodl.command(epilog="Example: ifgen nodl rewrite nodl/talker.nodl.yaml --merge")
@click.argument("source", type=EXISTING_FILE)
@click.option(
    "-o", "--output", metavar="FILE", type=OUTPUT_FILE, help="Write into this file, .yaml or .json."
)
@click.option(
    "-r", "--replace", "replaced", metavar="FROM:=TO", multiple=True, help="Replace a reference; repeatable."
)
@click.option("--merge", is_flag=True, help="Put everything that it includes into one document instead.")
@include_option
def rewrite(
    source: Path, output: Path | None, replaced: tuple[str, ...], merge: bool, include: tuple[Path, ...]
) -> int:
    """Write a document with other references, so that it can be installed.

    Comments and the order stay. No `local://` may be left: each FROM is a reference as it is written, or a
    `local://` to the same file. With --merge the result is one document without includes.
    """
    from ifgen_tools.nodl import contract, rewriting

    if merge:
        loaded = contract.read(source, include).loaded
        text = rewriting.merged(loaded, as_json=output is not None and output.suffix == ".json")
    else:
        text = rewriting.rewritten(source, contract.remaps_of(replaced))
    return _write(text, output)


@nodl.command(epilog="Example: ifgen nodl migrate robot.nodl.xml -o robot/nodl")
@click.argument("source", type=EXISTING_FILE)
@click.option(
    "-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Write NODE.nodl.yaml here."
)
@click.option("--force", is_flag=True, help="Replace files that exist.")
def migrate(source: Path, output: Path | None, force: bool) -> int:
    """Write the XML of NoDL 0.3 as documents of NoDL 2, one for each node.

    What the old form leaves open, such as QoS and defaults, gets ROS' own defaults and a comment.
    """
    from ifgen_tools.nodl.migration import migrated

    documents = migrated(source)
    files = {(output or Path()) / f"{name}.nodl.yaml": text for name, text in documents.items()}
    existing = [file for file in files if output is not None and not force and file.exists()]
    if existing:
        message = f"{existing[0]} exists"
        raise UsageError([Diagnostic("existing-file", message, help="replace it with --force")])
    for number, (file, text) in enumerate(files.items()):
        if output is None:
            click.echo(("---\n" if number else "") + text, nl=False)
        else:
            output.mkdir(parents=True, exist_ok=True)
            _write(text, file)
    return 0


def _write(text: str, output: Path | None) -> int:
    if output is None:
        click.echo(text, nl=False)
    else:
        output.write_text(text, encoding="utf-8")
        click.echo(f"{output}: written")
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

"""`ifgen graph`: which node talks to which, from node descriptions or from running programs."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click
from ifgen.command_kit.options import OUTPUT_FILE, include_option
from ifgen.command_kit.system import PATH_OR_ARGUMENT, extension, request, system_options
from ifgen.diagnostics import Diagnostic, UsageError

if TYPE_CHECKING:
    from ifgen_tools.graph.connections import Graph
    from ifgen_tools.verbs import TransportChoice

# Late imports: drawings of descriptions and of running programs have little in common.

Format = Literal["mermaid", "dot", "svg"]
_SUFFIXES: dict[str, Format] = {
    ".mmd": "mermaid",
    ".mermaid": "mermaid",
    ".dot": "dot",
    ".gv": "dot",
    ".svg": "svg",
}


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: ifgen graph --run talker.py -o graph.svg",
)
@click.argument("words", metavar="[PATH]...", nargs=-1, type=PATH_OR_ARGUMENT)
@click.option(
    "--format",
    "format_",
    type=click.Choice(["mermaid", "dot", "svg"]),
    help="Default: by FILE, else mermaid.",
)
@click.option("-o", "--output", metavar="FILE", type=OUTPUT_FILE, help="Write into this file.")
@system_options
@include_option
@click.option("--running", is_flag=True, help="Draw a running system instead.")
@click.option(
    "--transport",
    type=click.Choice(["local", "rclpy", "auto"]),
    envvar="IFGEN_TRANSPORT",
    default="auto",
    help="Where to look: our rclpy (local), the real one (rclpy), or the real one if it is installed (auto).",
)
@click.option(
    "--run",
    "programs",
    metavar="PROGRAM",
    multiple=True,
    help="Draw this program while it runs: 'talker.py', '-m package.node'; may be repeated.",
)
def graph(
    words: tuple[Path | str, ...],
    format_: Format | None,
    output: Path | None,
    system: bool,
    parameter_files: tuple[Path, ...],
    complete: bool,
    no_python: bool,
    lock: bool,
    include: tuple[Path, ...],
    running: bool,
    transport: TransportChoice,
    programs: tuple[str, ...],
) -> int:
    """Draw which node talks to which: Mermaid, DOT or SVG.

    PATH is a package with node descriptions, a folder of packages, or one .nodl.yaml file. The default is
    the paths in [tool.ifgen]. Endpoints that can never match are joined in red. A connection without a node
    at one end is dashed. With --system, PATH has launch files, too, and it draws what they start.
    """
    chosen = format_ or _format_of(output)
    running = running or bool(programs)
    if words and running:
        raise click.UsageError("--running and --run take no PATH", click.get_current_context())
    paths = [word for word in words if isinstance(word, Path)]
    if not system and (complete or no_python or lock or parameter_files or len(paths) < len(words)):
        raise click.UsageError("arguments and these options need --system", click.get_current_context())
    if system:
        asked = request(
            words,
            include=include,
            parameter_files=parameter_files,
            complete=complete,
            transport=transport,
            with_python=not no_python,
            lock=lock,
        )
        found: Graph = extension("graph")(asked)
    else:
        found = _running(programs, transport) if running else _described(paths, include)
    if not found.nodes:
        what, advice = (
            "there is no description of a node",
            "descriptions are in <package>/nodl/NAME.nodl.yaml",
        )
        if running:
            what, advice = "no node is running", "name a program, such as `--run talker.py`"
        raise UsageError([Diagnostic("no-node", what, help=advice)])
    text = _drawn(found, chosen)
    if output is None:
        print(text, end="")
    else:
        output.write_text(text, encoding="utf-8")
        open_ends = sum(connection.missing is not None for connection in found.connections)
        print(f"{output}: {len(found.nodes)} nodes, {len(found.connections)} connections, {open_ends} open")
    for problem in found.problems:
        print(f"warning: {problem}", file=sys.stderr)
    return 0


def _format_of(output: Path | None) -> Format:
    """The format that the name of a file stands for. Raises UsageError for an unknown suffix."""
    if output is None:
        return "mermaid"
    if output.suffix not in _SUFFIXES:
        message = f"'{output}' does not end in a format that can be drawn"
        advice = f"name it {', '.join(f'*{s}' for s in _SUFFIXES)}, or use --format"
        raise UsageError([Diagnostic("unknown-format", message, help=advice)])
    return _SUFFIXES[output.suffix]


def _drawn(found: Graph, format_: Format) -> str:
    from ifgen_tools.graph.svg import dot, mermaid, svg

    return {"mermaid": mermaid, "dot": dot, "svg": svg}[format_](found)


def _described(paths: Sequence[Path], include: Sequence[Path]) -> Graph:
    from ifgen.config.settings import settle
    from ifgen.nodl.load import load
    from ifgen.reading.packages import find_packages
    from ifgen.reading.search_path import SearchPath

    from ifgen_tools.graph.connections import of_descriptions

    settings = settle(paths, None, include).with_paths()
    packages = find_packages(settings.paths)
    loaded = load(packages, SearchPath(packages, settings.include))
    return of_descriptions(node for package in loaded.packages for node in package.nodes)


def _running(programs: Sequence[str], transport: TransportChoice) -> Graph:
    from ifgen_tools.beside import session_beside
    from ifgen_tools.graph.connections import of_endpoints
    from ifgen_tools.running import run

    words = [run.split(shlex.split(program))[0] for program in programs]
    with session_beside(words, transport) as session:
        view = session.graph().of_authors()
    return of_endpoints(view.nodes, view.endpoints)

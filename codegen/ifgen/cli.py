"""The commands: they read options, call the pipeline and print. Slow imports wait for their command.

With argparse, for typer, which validates with pydantic, takes 140 ms of CPU more for each command.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING

from ifgen import __version__, terminal
from ifgen.options import Parser, existing_folder, existing_path, output_folder
from ifgen.settings import Settings, settle

if TYPE_CHECKING:
    from ifgen.pipeline import Generated
    from ifgen.read import SearchPath


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, by default this process's, and give its exit code."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # names of files may hold what the terminal cannot show
            stream.reconfigure(errors="backslashreplace")
    parser = _parser()
    options = parser.parse_args(arguments)
    if "run" not in options:
        parser.print_help()
        return 2
    return terminal.exit_code_of(lambda: options.run(options))


def generate(options: argparse.Namespace) -> int:
    """`ifgen generate`."""

    def settings() -> Settings:
        given = (options.paths, options.output, options.include, options.with_deps, options.templates)
        return settle(*given).with_paths()

    if options.check:
        return _check_freshness(settings())
    if not options.watch:
        return _generate(settings())
    from ifgen.watch import watch  # watchfiles is a library of its own

    return watch(settings, _generate)


def check(options: argparse.Namespace) -> int:
    """`ifgen check`."""
    from ifgen import report
    from ifgen.diagnostics import InterfaceError
    from ifgen.pipeline import load

    settings = settle(options.paths, None, options.include).with_paths()
    summary = ""
    try:
        registry = load(*settings.paths, include=settings.include)
        found = registry.warnings
        if not found:
            packages = [registry.packages[name] for name in registry.requested]
            interfaces = _count(sum(len(package.interfaces) for package in packages), "interface")
            summary = f"{interfaces} in {_count(len(packages), 'package')}: no mistakes\n"
    except InterfaceError as error:
        found = error.diagnostics
    if options.format == "json":
        print(report.as_json(found))
    elif options.format == "github":
        print(report.as_github_annotations(found), end="\n" if found else "")
    else:
        terminal.print_diagnostics(found)
        print(summary, end="")
    return int(any(diagnostic.severity == "error" for diagnostic in found))


def show(options: argparse.Namespace) -> int:
    """`ifgen show`."""
    from ifgen import lookup

    described, registry = lookup.find_type(options.type, _search(options))
    if options.json:
        import json

        from ifgen.definition.type_description import describe

        print(json.dumps(describe(described, registry), indent=2))
    else:
        from ifgen import show as showing

        print("\n".join(showing.lines(described, registry)))
    return 0


def print_hashes(options: argparse.Namespace) -> int:
    """`ifgen hash`."""
    from ifgen import lookup
    from ifgen.definition.type_description import type_hash

    search = _search(options)
    described, registry = lookup.find_types(options.names or search.package_names(), search)
    print("\n".join(f"{d.type_name} {type_hash(d, registry)}" for d in described))
    return 0


def _parser() -> Parser:
    about = "ROS 2 interfaces as typed Python packages, with nothing to compile."
    parser = Parser(prog="ifgen", description=about)
    parser.add_argument("--version", action="version", version=f"ifgen {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", title="commands")

    command = commands.add_parser("generate", help="write typed Python packages for interface packages")
    command.set_defaults(run=generate)
    _add_paths(command)
    help = "write the packages into this folder (default: generated)"
    command.add_argument("-o", dest="output", metavar="DIR", type=output_folder, help=help)
    _add_include(command)
    help = "write the packages that they depend on as well"
    command.add_argument("--with-deps", action=argparse.BooleanOptionalAction, help=help)
    mode = command.add_mutually_exclusive_group()
    mode.add_argument(
        "--check", action="store_true", help="write nothing; show a diff and exit with 1 on drift"
    )
    mode.add_argument("--watch", action="store_true", help="stay, and generate again on every change")
    help = "templates of yours that replace ours"
    command.add_argument("--templates", metavar="DIR", type=existing_folder, help=help)

    command = commands.add_parser("check", help="look for mistakes in interfaces, and write nothing")
    command.set_defaults(run=check)
    _add_paths(command)
    _add_include(command)
    help = "for people (text), tools (json) or annotations on GitHub"
    command.add_argument("--format", choices=["text", "json", "github"], default="text", help=help)

    command = commands.add_parser("show", help="print an interface with its nested types and its type hash")
    command.set_defaults(run=show)
    command.add_argument("type", metavar="TYPE", help="such as geometry_msgs/msg/Pose")
    _add_include(command)
    command.add_argument("--json", action="store_true", help="print the ROS type description instead")

    command = commands.add_parser("hash", help="print type hashes, those of derived types included")
    command.set_defaults(run=print_hashes)
    help = "such as std_msgs/msg/String or std_msgs (default: all that can be found)"
    command.add_rest("names", "TYPE|PACKAGE", str, help)
    _add_include(command)
    return parser


def _add_paths(command: Parser) -> None:
    help = (
        "an interface package, a folder of them, or one .msg, .srv or .action file "
        "(default: paths in [tool.ifgen] of pyproject.toml)"
    )
    command.add_rest("paths", "PATH", existing_path, help)


def _add_include(command: Parser) -> None:
    help = "find dependencies in this folder too; may be repeated"
    command.add_argument(
        "-I", dest="include", metavar="DIR", action="append", type=existing_folder, help=help
    )


def _generate(settings: Settings) -> int:
    from ifgen import pipeline

    with terminal.progress_bar("generating") as progress:
        done = pipeline.generate(
            *settings.paths,
            output=settings.output,
            include=settings.include,
            with_deps=settings.with_deps,
            templates=settings.templates,
            progress=progress,
        )
    _report(done, settings.output)
    return 0


def _report(done: Generated, output: Path) -> None:
    from ifgen.report import shown_path

    if done.warnings:
        terminal.print_diagnostics(done.warnings, stderr=True)
    for path in done.removed:
        print(f"removed {shown_path(path)}")
    for path in done.kept:
        print(
            f"warning: {shown_path(path)} is generated no longer, but was edited: it stays", file=sys.stderr
        )
    where = shown_path(output)
    if done.written or done.removed:
        counts = ((done.written, "written"), (done.unchanged, "unchanged"), (done.removed, "removed"))
        print(
            f"{where}: "
            + ", ".join(f"{_count(len(paths), 'file')} {what}" for paths, what in counts if paths)
        )
    else:
        print(f"{where}: up to date ({_count(len(done.unchanged), 'file')})")


def _check_freshness(settings: Settings) -> int:
    from ifgen import pipeline
    from ifgen.report import shown_path

    with terminal.progress_bar("checking") as progress:
        drifts = pipeline.drift(
            *settings.paths,
            output=settings.output,
            include=settings.include,
            with_deps=settings.with_deps,
            templates=settings.templates,
            progress=progress,
        )
    if not drifts:
        print(f"{shown_path(settings.output)}: up to date")
        return 0
    terminal.print_drift(drifts)
    verb = "differs" if len(drifts) == 1 else "differ"
    advice = "run `ifgen generate`"
    print(f"{_count(len(drifts), 'file')} {verb} from what the interfaces give: {advice}", file=sys.stderr)
    return 1


def _search(options: argparse.Namespace) -> SearchPath:
    """Where types are found by name: in the configured paths first."""
    from ifgen.read import SearchPath, find_packages

    settings = settle(None, None, options.include)
    return SearchPath(find_packages(settings.paths), settings.include)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"

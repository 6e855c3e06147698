"""The commands: they read options, call the pipeline and print. Slow imports wait for their command."""

from __future__ import annotations

import sys
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from ifgen import __version__, terminal
from ifgen.settings import Settings, settle

if TYPE_CHECKING:
    from ifgen.diagnostics import Diagnostic
    from ifgen.read import SearchPath
    from ifgen.write import Written

app = typer.Typer(
    name="ifgen",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # plain help: the same in a pipe, and half the start-up time
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Paths = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="PATH",
        exists=True,
        show_default=False,
        help="An interface package, a folder of them, or one .msg, .srv or .action file "
        "[default: paths in [tool.ifgen] of pyproject.toml]",
    ),
]
Include = Annotated[
    list[Path] | None,
    typer.Option(
        "-I", metavar="DIR", exists=True, file_okay=False, help="Find dependencies here too; repeatable"
    ),
]


T = TypeVar("T")


class Format(StrEnum):
    """How `ifgen check` prints what it found."""

    text = "text"
    json = "json"
    github = "github"


def main() -> None:
    """Run the command line; never returns."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # names of files may hold what the terminal cannot show
            stream.reconfigure(errors="backslashreplace")
    app()


@app.callback(invoke_without_command=True)
def root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit")] = False,
) -> None:
    """ROS 2 interfaces as typed Python packages, with nothing to compile."""
    if version:
        typer.echo(f"ifgen {__version__}")
        raise typer.Exit


@app.command()
def generate(
    paths: Paths = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", metavar="DIR", show_default=False, help="Write the packages here [default: generated]"
        ),
    ] = None,
    include: Include = None,
    with_deps: Annotated[
        bool | None,
        typer.Option(
            "--with-deps/--without-deps", show_default=False, help="Write what they depend on as well"
        ),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; show a diff, and exit 1 if there is one")
    ] = False,
    watch: Annotated[bool, typer.Option("--watch", help="Go on, and generate again on every change")] = False,
    templates: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", exists=True, file_okay=False, help="Templates of yours that replace ifgen's"
        ),
    ] = None,
) -> None:
    """Write typed Python packages for interface packages."""
    if check and watch:
        raise typer.BadParameter("--check and --watch do not go together")

    def settings() -> Settings:
        return settle(paths, output, include, with_deps, templates).with_paths()

    if watch:
        from ifgen import watch as watching  # watchfiles is a library of its own

        watching.watch(lambda: _unless_it_fails(settings), lambda s: _unless_it_fails(lambda: _generate(s)))
        return
    with terminal.failures_reported():
        if check:
            _check_freshness(settings())
        else:
            _generate(settings())


@app.command()
def check(
    paths: Paths = None,
    include: Include = None,
    format: Annotated[
        Format, typer.Option("--format", help="For people, tools, or GitHub Actions")
    ] = Format.text,
) -> None:
    """Look for mistakes in interfaces; write nothing."""
    from ifgen import report
    from ifgen.diagnostics import InterfaceError
    from ifgen.pipeline import load

    with terminal.failures_reported():
        settings = settle(paths, None, include).with_paths()
        found: tuple[Diagnostic, ...] = ()
        summary = ""
        try:
            registry = load(*settings.paths, include=settings.include)
            interfaces = sum(len(registry.packages[name].interfaces) for name in registry.requested)
            packages = len(registry.requested)
            summary = f"{_count(interfaces, 'interface')} in {_count(packages, 'package')}: no mistakes"
        except InterfaceError as error:
            found = error.diagnostics
        if format is Format.json:
            typer.echo(report.as_json(found))
        elif format is Format.github and found:
            typer.echo(report.as_github_annotations(found))
        elif format is Format.text:
            terminal.print_diagnostics(found, stderr=False)
            if summary:
                typer.echo(summary)
    if any(diagnostic.severity == "error" for diagnostic in found):
        raise typer.Exit(1)


@app.command()
def show(
    type_name: Annotated[
        str, typer.Argument(metavar="TYPE", help="Such as geometry_msgs/msg/Pose", show_default=False)
    ],
    include: Include = None,
    json: Annotated[bool, typer.Option("--json", help="Print the ROS type description instead")] = False,
) -> None:
    """Print an interface with its nested types and its type hash."""
    from ifgen import lookup

    with terminal.failures_reported():
        described, registry = lookup.find_type(type_name, _search(include))
        if json:
            from json import dumps

            from ifgen.definition.type_description import describe

            typer.echo(dumps(describe(described, registry), indent=2))
        else:
            from ifgen import show as showing

            typer.echo("\n".join(showing.lines(described, registry)))


@app.command("hash")
def print_hashes(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="TYPE|PACKAGE", help="[default: everything that can be found]", show_default=False
        ),
    ] = None,
    include: Include = None,
) -> None:
    """Print type hashes, those of derived types included.

    One a line: `pkg/msg/Name RIHS01_...`.
    """
    from ifgen import lookup
    from ifgen.definition.type_description import type_hash

    with terminal.failures_reported():
        search = _search(include)
        described, registry = lookup.find_types(names or search.package_names(), search)
        typer.echo("\n".join(f"{d.type_name} {type_hash(d, registry)}" for d in described))


def _generate(settings: Settings) -> None:
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


def _report(done: Written, output: Path) -> None:
    from ifgen.report import shown_path

    for path in done.removed:
        typer.echo(f"removed {shown_path(path)}")
    for path in done.kept:
        typer.echo(f"warning: {shown_path(path)} is no longer generated, but was edited: it stays", err=True)
    where = shown_path(output)
    if done.written or done.removed:
        counts = [
            (len(done.written), "written"),
            (len(done.unchanged), "unchanged"),
            (len(done.removed), "removed"),
        ]
        typer.echo(f"{where}: " + ", ".join(f"{_count(n, 'file')} {what}" for n, what in counts if n))
    else:
        typer.echo(f"{where}: up to date ({_count(len(done.unchanged), 'file')})")


def _check_freshness(settings: Settings) -> None:
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
        typer.echo(f"{shown_path(settings.output)}: up to date")
        return
    terminal.print_drift(drifts)
    verb = "differs" if len(drifts) == 1 else "differ"
    message = f"{_count(len(drifts), 'file')} {verb} from what the interfaces give: run `ifgen generate`"
    typer.echo(message, err=True)
    raise typer.Exit(1)


def _unless_it_fails(action: Callable[[], T]) -> T | None:
    """Do something and report its failure, but go on: the next change may mend it."""
    try:
        with terminal.failures_reported():
            return action()
    except typer.Exit:
        return None


def _search(include: list[Path] | None) -> SearchPath:
    """Where types are found by name: the configured paths come first."""
    from ifgen.read import SearchPath, find_packages

    settings = settle(None, None, include)
    return SearchPath(find_packages(settings.paths), settings.include)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"

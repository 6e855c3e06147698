"""The command `ifgen doc`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from ifgen.command_kit import terminal
from ifgen.command_kit.options import (
    EXISTING,
    FOLDER,
    OUTPUT_FOLDER,
    WithDepsCommand,
    include_option,
    quiet_option,
    with_deps_option,
)
from ifgen.config.customization import Customization, Target
from ifgen.config.settings import settle
from ifgen.diagnostics import shown_path
from ifgen.signals import sigterm_raises

if TYPE_CHECKING:
    from ifgen.reading.search_path import WithDeps

# Late imports: the stages take longest to load.

_GENERATOR: Final = "html"


@click.command(cls=WithDepsCommand, epilog="Example: ifgen doc interfaces -o site")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@click.option(
    "-o", "--output", metavar="DIR", type=OUTPUT_FOLDER, default=Path("site"), help="Default: site."
)
@click.option("--title", metavar="TEXT", default="Interfaces", help="The title of the site.")
@click.option("--version", "version_", metavar="TEXT", default="", help="The version of what it describes.")
@click.option(
    "--templates", metavar="DIR", type=FOLDER, help="Your templates, which win over those of the site."
)
@include_option
@with_deps_option
@quiet_option
def doc(  # noqa: PLR0913, PLR0917 - one for each option
    paths: tuple[Path, ...],
    output: Path,
    title: str,
    version_: str,
    templates: Path | None,
    include: tuple[Path, ...],
    with_deps: WithDeps | None,
    quiet: bool,
) -> int:
    """Write a site about interfaces and nodes.

    It has a page for each package, interface and node, with search, and works from a folder and without a
    network. With --with-deps the packages that yours need have pages too.

    PATH is a package, a folder of packages, or one .msg, .srv, .action, .idl or .nodl.yaml file. The default
    is the paths in [tool.ifgen] of pyproject.toml. `use = "html"` in [tool.ifgen.generate] does the same.
    """
    from ifgen.pipeline import stages

    settings = settle(paths, None, include, with_deps).with_paths()
    options = {"title": title, "version": version_}
    target = Target("doc", output, use=_GENERATOR, options=options, templates=templates)
    target = replace(target, with_deps=bool(settings.with_deps))
    with sigterm_raises():
        done = stages.generate(
            *settings.paths,
            output=output,
            include=settings.include,
            templates=Customization(python=False, targets=(target,)),
            exclude=settings.exclude,
        )
    terminal.print_diagnostics(settings.policy.told(done.diagnostics), stderr=True)
    if not quiet:
        written = terminal.counted(len(done.written), "file")
        print(f"{shown_path(output)}: {written} written, {len(done.unchanged)} unchanged")
        print(f"open {shown_path(output / 'index.html')}")
    return 0

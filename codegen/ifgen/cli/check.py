"""The command `ifgen check`."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.command_kit import terminal
from ifgen.command_kit.options import EXISTING, format_option, include_option, quiet_option, strict_option
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, shown_path
from ifgen.signals import sigterm_raises

if TYPE_CHECKING:
    from ifgen.pipeline.inspection import Findings

# Late imports: `ifgen --help` loads this module, and does without the compiler.


@click.command(epilog="Example: ifgen check interfaces --strict")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@include_option
@format_option
@strict_option
@quiet_option
@click.option("--fix", is_flag=True, help="Fix what follows from a finding alone, then check again.")
@click.option("--diff", is_flag=True, help="Show what --fix would change, and write nothing.")
def check(
    paths: tuple[Path, ...],
    include: tuple[Path, ...],
    format_: str,
    strict: bool | None,
    quiet: bool,
    fix: bool,
    diff: bool,
) -> int:
    """Look for mistakes, and write nothing, except with --fix.

    Checks interfaces, node descriptions, and your own node modules. --fix adds dependencies to package.xml
    and CMakeLists.txt, and writes `pkg/Type` for `pkg::Type`.

    PATH is a package, a folder of packages, or one .msg, .srv, .action, .idl or .nodl.yaml file. The default
    is the paths in [tool.ifgen] of pyproject.toml. A parameter file (.yaml) is compared with what the nodes
    of the other paths, or of the default, declare.
    """
    from ifgen.pipeline.inspection import inspect, split_parameter_files

    paths, parameter_files = split_parameter_files(paths)
    settings = settle(paths, None, include, strict=strict).with_paths()
    while True:
        findings = inspect(
            *settings.paths,
            include=settings.include,
            output=settings.output,
            ros_distro=settings.custom.ros_distro,
            exclude=settings.exclude,
            parameter_files=parameter_files,
        )
        told = settings.policy.told(findings.diagnostics)
        if diff or not fix or not _fix(told):
            break
    if diff:
        from ifgen.pipeline.fixing import fixed

        terminal.print_changes((path, *texts) for path, texts in fixed(told).items())
    return terminal.print_findings(told, format_, "" if quiet else f"{_looked_at(findings)}: no mistakes")


def _fix(told: Sequence[Diagnostic]) -> bool:
    """Fix what can be fixed of what was found; whether a file has changed."""
    from ifgen.pipeline.fixing import fixed
    from ifgen.writing import transaction

    texts = fixed(told)
    if texts:
        top = Path(os.path.commonpath([path.absolute().parent for path in texts]))
        with sigterm_raises():
            transaction.apply([(path.absolute(), after.encode()) for path, (_, after) in texts.items()], top)
        for path in texts:
            print(f"fixed {shown_path(path)}", file=sys.stderr)
    return bool(texts)


def _looked_at(findings: Findings) -> str:
    counts = ((findings.interfaces, "interface"), (findings.nodes, "node"))
    what = " and ".join(terminal.counted(number, noun) for number, noun in counts if number)
    return f"{what} in {terminal.counted(findings.packages, 'package')}"

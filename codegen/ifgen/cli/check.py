"""The command `ifgen check`."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.command_kit import terminal
from ifgen.command_kit.options import format_option, include_option, quiet_option, strict_option
from ifgen.command_kit.system import PATH_OR_ARGUMENT, extension, request, system_options
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, shown_path
from ifgen.signals import sigterm_raises

if TYPE_CHECKING:
    from ifgen.pipeline.inspection import Findings

# Late imports: `ifgen --help` loads this module, and does without the compiler.


@click.command(epilog="Example: ifgen check interfaces --strict")
@click.argument("words", metavar="[PATH]...", nargs=-1, type=PATH_OR_ARGUMENT)
@system_options
@include_option
@format_option
@strict_option
@quiet_option
@click.option("--fix", is_flag=True, help="Fix what follows from a finding alone, then check again.")
@click.option("--diff", is_flag=True, help="Show what --fix would change, and write nothing.")
def check(
    words: tuple[Path | str, ...],
    system: bool,
    parameter_files: tuple[Path, ...],
    complete: bool,
    no_python: bool,
    lock: bool,
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

    With --system, PATH has launch files, too, and NAME:=VALUE for them: it says who does not meet whom, and
    which parameters are wrong, before anything starts.
    """
    if system:
        asked = request(
            words,
            include=include,
            parameter_files=parameter_files,
            complete=complete,
            with_python=not no_python,
            lock=lock,
        )
        code: int = extension("check")(asked, format_, strict=strict, quiet=quiet)
        return code
    if complete or no_python or lock or any(isinstance(word, str) for word in words):
        raise click.UsageError("arguments and these options need --system", click.get_current_context())
    from ifgen.pipeline.inspection import inspect, split_parameter_files

    paths, more = split_parameter_files([word for word in words if isinstance(word, Path)])
    settings = settle(paths, None, include, strict=strict).with_paths()
    while True:
        findings = inspect(
            *settings.paths,
            include=settings.include,
            output=settings.output,
            ros_distro=settings.custom.ros_distro,
            exclude=settings.exclude,
            parameter_files=(*parameter_files, *more),
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

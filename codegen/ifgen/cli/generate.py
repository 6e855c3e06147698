"""`ifgen generate`: files, what changed, and whether anything differs."""

from __future__ import annotations

import gc
import sys
from collections import Counter
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
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
    strict_option,
    with_deps_option,
)
from ifgen.config.settings import Settings, settle
from ifgen.diagnostics import Diagnostic, any_errors, shown_path
from ifgen.signals import sigterm_raises

if TYPE_CHECKING:
    from ifgen.pipeline.stages import Generated
    from ifgen.pipeline.values import Condition, LeftOut
    from ifgen.reading.search_path import WithDeps

_UNDECLARED: Final = "undeclared-dependency"
_MOST_REMOVED: Final = 20
"""Lines about what was removed; the rest is only counted."""

# Late imports: the stages take longest to load, and a mistake in an option is told without them.


@click.command(cls=WithDepsCommand, epilog="Example: ifgen generate interfaces -o src")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=OUTPUT_FOLDER,
    help="Write into this folder (default: generated).",
)
@include_option
@with_deps_option
@click.option("--tests/--no-tests", default=None, help="Write tests for them (the default).")
@click.option("--check", is_flag=True, help="Write nothing; show a diff and exit with 1 on drift.")
@click.option("--exit-non-zero-on-change", is_flag=True, help="Exit with 1 if a file was written or removed.")
@click.option("--watch", is_flag=True, help="Keep running, and generate again on every change.")
@click.option("--locked", is_flag=True, help="Fail if an interface differs from ifgen.lock.")
@click.option("--templates", metavar="DIR", type=FOLDER, help="Your own templates, which replace ifgen's.")
@click.option("--exclude", metavar="PATTERN", multiple=True, help="Leave out a package, or demo_msgs/msg/*.")
@click.option("--keep-going", is_flag=True, help="Generate what is right although other files are wrong.")
@click.option("--isolated", is_flag=True, help="Read no pyproject.toml, so run none of the code it names.")
@strict_option
@quiet_option
def generate(
    paths: tuple[Path, ...],
    output: Path | None,
    include: tuple[Path, ...],
    with_deps: WithDeps | None,
    tests: bool | None,
    check: bool,
    exit_non_zero_on_change: bool,
    watch: bool,
    locked: bool,
    templates: Path | None,
    exclude: tuple[str, ...],
    keep_going: bool,
    isolated: bool,
    strict: bool | None,
    quiet: bool,
) -> int:
    """Write typed Python packages.

    Packages of nodes are ament_python packages. Templates and filters that [tool.ifgen] names are code. Only
    this command, `run --generate` and `templates check` run it.

    PATH is a package, a folder of packages, or one .msg, .srv, .action, .idl or .nodl.yaml file. The default
    is the paths in [tool.ifgen] of pyproject.toml.
    """

    def settings() -> Settings:
        options = (paths, output, include, with_deps, templates, tests, strict)
        chosen = settle(*options, isolated=isolated, exclude=exclude)
        return chosen.with_paths().trusted()

    if keep_going and locked:
        message = "--keep-going cannot be used with --locked, which is about all interfaces"
        raise click.UsageError(message, click.get_current_context())
    run = partial(_check_freshness if check else write, quiet=quiet, locked=locked, keep_going=keep_going)
    if watch and (check or exit_non_zero_on_change):
        option = "--check" if check else "--exit-non-zero-on-change"
        raise click.UsageError(f"{option} cannot be used with --watch", click.get_current_context())
    if exit_non_zero_on_change and not check:
        run = partial(run, changes_fail=True)
    with sigterm_raises():
        if not watch:
            with without_garbage_collection():
                return run(settings())
        from ifgen.cli import watch as watching  # watchfiles is a library of its own

        return watching.watch(settings, run, quiet=quiet)


@contextmanager
def without_garbage_collection() -> Generator[None]:
    """Collect nothing in the block, and nothing that is left of it later: that saves a sixth of the time."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def write(
    settings: Settings,
    *,
    quiet: bool = False,
    locked: bool = False,
    keep_going: bool = False,
    changes_fail: bool = False,
) -> int:
    """Generate, print what changed, and return the exit code."""
    from ifgen.pipeline import stages

    try:
        with terminal.progress_bar("generating") as progress:
            done = stages.generate(
                *settings.paths,
                output=settings.output,
                include=settings.include,
                with_deps=settings.with_deps,
                templates=settings.custom,
                progress=progress,
                condition=_condition(locked, settings),
                exclude=settings.exclude,
                keep_going=keep_going,
            )
    except KeyboardInterrupt as stop:
        stop.args = stop.args or ("no file was changed",)
        raise
    told = _in_short(settings.policy.told(done.diagnostics))
    terminal.print_diagnostics(told, stderr=True)
    _say_what_is_left_out(done.left_out)
    if not quiet:
        _report(done, settings)
    return int(any_errors(told) or (changes_fail and bool(done.written or done.removed)))


def _in_short(found: Sequence[Diagnostic]) -> Sequence[Diagnostic]:
    """The diagnostics, with one for all undeclared dependencies of a package; `ifgen check` has each."""
    counts = Counter(each.message.partition(" ")[0] for each in found if each.rule == _UNDECLARED)
    short: list[Diagnostic] = []
    for each in found:
        package = each.message.partition(" ")[0]
        count = counts[package] if each.rule == _UNDECLARED else 1
        if count > 1:
            message = f"{package} uses {count} packages without declaring them"
            advice = "`ifgen check` shows each, and what to add to package.xml and CMakeLists.txt"
            short.append(replace(each, message=message, primary=None, secondary=(), help=advice))
            counts[package] = 0
        elif count:
            short.append(each)
    return short


def _say_what_is_left_out(left_out: Sequence[LeftOut]) -> None:
    for left in left_out:
        print(f"left out: {left.name}: {left.reason}", file=sys.stderr)


def _report(done: Generated, settings: Settings) -> None:
    output, targets = settings.output, [target.out for target in settings.custom.targets]
    folders = sorted({output, *targets}, key=lambda folder: (len(folder.parts), folder), reverse=True)
    removed = list(dict.fromkeys(_whole_package(path, folders) or path for path in done.removed))
    for path in removed[:_MOST_REMOVED]:
        print(f"removed {shown_path(path)}")
    if more := removed[_MOST_REMOVED:]:
        print(f"removed {len(more)} more, the last of them {shown_path(more[-1])}")
    if settings.custom.partial and targets:
        listed = ", ".join(shown_path(folder) for folder in dict.fromkeys(targets))
        print(f"{listed}: as before, because targets are about all paths: run `ifgen generate` without PATH")
        targets = []
    for folder in dict.fromkeys((output, *targets)):
        _report_folder(done, folder, folders, always=folder == output and settings.custom.python)


def _report_folder(done: Generated, folder: Path, folders: Sequence[Path], *, always: bool) -> None:
    written, unchanged, removed = (
        [path for path in paths if _folder_of(path, folders) == folder]
        for paths in (done.written, done.unchanged, done.removed)
    )
    where = shown_path(folder)
    if written or removed:
        counts = ((written, "written"), (unchanged, "unchanged"), (removed, "removed"))
        print(
            f"{where}: "
            + ", ".join(f"{terminal.counted(len(paths), 'file')} {what}" for paths, what in counts if paths)
        )
    elif unchanged or always:
        print(f"{where}: up to date ({terminal.counted(len(unchanged), 'file')})")


def _folder_of(path: Path, folders: Sequence[Path]) -> Path:
    """The innermost of these folders that a file is in."""
    return next(folder for folder in folders if path.is_relative_to(folder))


def _whole_package(path: Path, folders: Sequence[Path]) -> Path | None:
    """The folder of the package that a removed file was in, if nothing of that is left."""
    output = _folder_of(path, folders)
    folder = output / path.relative_to(output).parts[0]
    return None if folder.exists() else folder


def _condition(locked: bool, settings: Settings) -> Condition | None:
    if not locked:
        return None
    from ifgen.cli.evolution.lock import condition

    return condition(settings)


def _check_freshness(
    settings: Settings, *, quiet: bool = False, locked: bool = False, keep_going: bool = False
) -> int:
    from ifgen.pipeline import stages

    with terminal.progress_bar("checking") as progress:
        found = stages.drift(
            *settings.paths,
            output=settings.output,
            include=settings.include,
            with_deps=settings.with_deps,
            templates=settings.custom,
            progress=progress,
            condition=_condition(locked, settings),
            exclude=settings.exclude,
            keep_going=keep_going,
        )
    told = _in_short(settings.policy.told(found.diagnostics))
    terminal.print_diagnostics(told, stderr=True)
    _say_what_is_left_out(found.left_out)
    drifts = found.drifts
    if not drifts:
        if not quiet:
            custom = settings.custom
            folders = [settings.output] if custom.python else []
            folders += [] if custom.partial else [target.out for target in custom.targets]
            print("\n".join(f"{shown_path(folder)}: up to date" for folder in dict.fromkeys(folders)))
        return int(any_errors(told))
    terminal.print_drift(drifts)
    verb = "is" if len(drifts) == 1 else "are"
    advice = "run `ifgen generate`"
    print(f"{terminal.counted(len(drifts), 'file')} {verb} not up to date: {advice}", file=sys.stderr)
    if any(drift.only_line_ends for drift in drifts):
        kept = f"{Path(shown_path(settings.output)).as_posix()}/** text=auto eol=lf"
        print(f"  = help: git changes line ends here; put `{kept}` into .gitattributes", file=sys.stderr)
    return 1

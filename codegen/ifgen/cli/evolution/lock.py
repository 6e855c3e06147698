"""`ifgen lock`, and the condition that `ifgen generate --locked` sets."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.command_kit import terminal
from ifgen.command_kit.options import (
    EXISTING,
    WithDepsCommand,
    include_option,
    quiet_option,
    with_deps_option,
)
from ifgen.config.settings import Settings, settle
from ifgen.diagnostics import InputError, Source, shown_path
from ifgen.pipeline.values import Condition
from ifgen.reading.storage import read_source
from ifgen.signals import sigterm_raises
from ifgen.writing import transaction

if TYPE_CHECKING:
    from ifgen.definition.interfaces import Registry
    from ifgen.reading.search_path import WithDeps

# Late imports: the stages take longest to load, and a mistake in an option is told without them. A run with
# `--locked` that has nothing to do compares nothing.


@click.command(cls=WithDepsCommand, epilog="Example: ifgen lock --with-deps=own")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@include_option
@with_deps_option
@click.option("--check", is_flag=True, help="Write nothing; show a diff and exit with 1 on drift.")
@quiet_option
def lock(
    paths: tuple[Path, ...],
    include: tuple[Path, ...],
    with_deps: WithDeps | None,
    check: bool,
    quiet: bool,
) -> int:
    """Write ifgen.lock: your interfaces, and all that they need.

    The file has the type hash and the full definition of each interface that `ifgen generate` reads for the
    same arguments. `ifgen generate --locked` fails if one of them has changed. The file is beside
    pyproject.toml. Commit it.

    PATH is a package, a folder of packages, or one .msg, .srv, .action, .idl or .nodl.yaml file. The default
    is the paths in [tool.ifgen] of pyproject.toml.
    """
    from ifgen.evolution.lock import text as lock_text
    from ifgen.pipeline import stages

    settings = settle(paths, None, include, with_deps).with_paths()
    registries = stages.registries(
        *settings.paths,
        output=settings.output,
        include=settings.include,
        with_deps=settings.with_deps,
        exclude=settings.exclude,
    )
    path, text = _path(settings), lock_text.text(registries)
    if check:
        return _check(path, text, quiet=quiet)
    changed = _changes(path, text)
    if changed:
        with sigterm_raises():
            transaction.apply([(path, text.encode())], path.parent)
    if not quiet:
        print(f"{shown_path(path)}: {changed or 'up to date'} ({_counted(registries)})")
    return 0


def condition(settings: Settings) -> Condition:
    """The condition that the interfaces are those in the lock file. Raises InputError if that is missing."""
    from ifgen.evolution.lock import file as lock_file

    source = lock_file.source(_path(settings))

    def compare(registries: Iterable[Registry]) -> None:
        from ifgen.evolution.lock import comparison
        from ifgen.evolution.lock import text as lock_text

        registries = tuple(registries)
        if lock_text.text(registries) != source.text:  # faster than to read it, and usually the end
            comparison.check(lock_file.parse(source), registries)

    return Condition(hashlib.sha256(source.text.encode()).hexdigest(), compare)


def _path(settings: Settings) -> Path:
    from ifgen.evolution.lock.text import NAME

    return (settings.file.parent if settings.file else Path.cwd()) / NAME


def _check(path: Path, text: str, *, quiet: bool) -> int:
    from ifgen.evolution.lock import file as lock_file

    source = lock_file.source(path)
    if source.text == text:
        if not quiet:
            print(f"{shown_path(path)}: up to date")
        return 0
    lock_file.parse(source)  # a file with a mistake in it is no drift
    terminal.print_changes([(path, source.text, text)])
    print(f"{shown_path(path)} is not up to date: run `ifgen lock`", file=sys.stderr)
    return 1


def _changes(path: Path, text: str) -> str:
    """The difference between the file and its new text, in words; empty if there is none."""
    from ifgen.evolution.lock import file as lock_file

    if not path.exists():
        return "written"
    try:
        source = read_source(path)
        if source.text == text:
            return ""
        before = lock_file.parse(source).hashes
    except InputError:  # that is a reason to run this command
        return "written again"
    after = lock_file.parse(Source(path, text)).hashes
    added, removed = after.keys() - before.keys(), before.keys() - after.keys()
    changed = {name for name in before.keys() & after.keys() if before[name] != after[name]}
    counts = ((added, "added"), (changed, "changed"), (removed, "removed"))
    return ", ".join(f"{len(names)} {what}" for names, what in counts if names) or "written"


def _counted(registries: Iterable[Registry]) -> str:
    names = {interface.type_name for registry in registries for interface in registry}
    packages = {name.partition("/")[0] for name in names}
    return f"{terminal.counted(len(names), 'interface')} of {terminal.counted(len(packages), 'package')}"

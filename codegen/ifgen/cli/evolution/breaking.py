"""`ifgen breaking`: what the interfaces and nodes here break of what they were."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ifgen.cli.generate import without_garbage_collection
from ifgen.command_kit import completion, terminal
from ifgen.command_kit.options import EXISTING, format_option, include_option, quiet_option
from ifgen.config.settings import Settings, settle
from ifgen.config.suppressions import Policy, by_comments
from ifgen.diagnostics import Diagnostic, Source

if TYPE_CHECKING:
    from ifgen.evolution.edits import Category
    from ifgen.evolution.version import Version

# Late imports: a request for help needs none of these.


@click.command(epilog="Example: ifgen breaking --against main")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@click.option(
    "--against",
    metavar="REF",
    required=True,
    shell_complete=completion.revisions,
    help="The earlier version: a git revision, a folder, or a lock file.",
)
@click.option(
    "--category",
    type=click.Choice(["source", "hash", "wire"]),
    help="What no change may break. Default: `breaking` in [tool.ifgen], else source.",
)
@click.option(
    "--allow-no-commit", is_flag=True, help="Succeed where the repository has no commit yet: for hooks."
)
@include_option
@format_option
@quiet_option
def breaking(
    paths: tuple[Path, ...],
    against: str,
    category: str | None,
    allow_no_commit: bool,
    include: tuple[Path, ...],
    format_: str,
    quiet: bool,
) -> int:
    """Look for changes that break other programs, and write nothing.

    Compares interfaces and node descriptions with their earlier version REF. Nothing is checked out.

    \b
    wire    bytes change their meaning: recorded data, and peers on any middleware
    hash    the type hash changes: peers on rmw_zenoh or Kilted no longer match.
            Includes wire.
    source  Python code no longer works. Includes hash and wire.

    PATH is as for `ifgen check`. Exits with 1 if a change breaks the category. `ifgen rules` lists the rules,
    which `ignore` and `per_file_ignores` in [tool.ifgen] and comments silence as they do warnings.
    """  # noqa: D301 - the backspace is for click, which keeps the lines after it as they are
    from ifgen.reading import revisions

    settings = settle(paths, None, include).with_paths()
    if allow_no_commit and revisions.has_no_commit(Path.cwd()):
        return 0
    with without_garbage_collection():
        return _compared(settings, against, category, format_, quiet)


def _compared(settings: Settings, against: str, category: str | None, format_: str, quiet: bool) -> int:
    from ifgen.evolution import reference
    from ifgen.evolution.edits import Category

    base = settings.file.parent if settings.file is not None else Path.cwd()
    new = reference.current(settings.paths, settings.include)
    old = reference.earlier(against, settings.paths, settings.include, base, new)
    chosen = Category(category or settings.config.breaking)
    found = [*new.mistakes, *_broken(old, new, chosen, settings.policy)]
    found += (replace(mistake, severity="warning") for mistake in old.mistakes)
    counts = ((len(new.interfaces), "interface"), (len(new.nodes or ()), "node"))
    what = " and ".join(terminal.counted(number, noun) for number, noun in counts if number) or "nothing"
    return terminal.print_findings(
        found, format_, "" if quiet else f"{what}: no change since {against} breaks {chosen}"
    )


def _broken(old: Version, new: Version, category: Category, policy: Policy) -> list[Diagnostic]:
    """The changes that break a category, as errors, without those that are ignored."""
    from ifgen.evolution.compare import compare
    from ifgen.evolution.rules import is_broken
    from ifgen.evolution.words import diagnostic

    found = (diagnostic(d) for d in compare(old, new) if is_broken(category, d.edit))
    told = _without_ignored(d for d in found if d is not None and not policy.silences(d))
    return sorted((replace(d, severity="error") for d in told), key=_place)


def _place(diagnostic: Diagnostic) -> tuple[str, int]:
    span = diagnostic.primary.span if diagnostic.primary is not None else None
    return ("", 0) if span is None else (str(span.source.path), span.start)


def _without_ignored(found: Iterable[Diagnostic]) -> Sequence[Diagnostic]:
    """The diagnostics that no comment in their file ignores, file by file."""
    of_files: dict[Source | None, list[Diagnostic]] = {}
    for diagnostic in found:
        source = diagnostic.primary.span.source if diagnostic.primary else None
        of_files.setdefault(source if source and source.revision is None else None, []).append(diagnostic)
    return [
        diagnostic
        for source, of_file in of_files.items()
        for diagnostic in (by_comments(source, of_file, complete=False) if source else of_file)
    ]

"""`ifgen breaking` and `ifgen diff`: two versions of interfaces and nodes, by rule or side by side."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from ifgen.cli.generate import without_garbage_collection
from ifgen.command_kit import completion, terminal
from ifgen.command_kit.options import EXISTING, format_option, include_option, quiet_option
from ifgen.command_kit.system import extension
from ifgen.config.settings import Settings, settle
from ifgen.config.suppressions import Policy, by_comments
from ifgen.diagnostics import Diagnostic, Source, UsageError

if TYPE_CHECKING:
    from rich.text import Text

    from ifgen.definition.interfaces import Interface, Registry
    from ifgen.evolution.edits import Category
    from ifgen.evolution.selection import Selection
    from ifgen.evolution.version import Version

# Late imports: a request for help needs none of these.

_HEAD: Final = 3
"""Lines before a definition: where it is from, the name and the hash of the type."""

_HASH: Final = 23
"""Characters of a hash that fit into a column."""


@click.command(epilog="Example: ifgen breaking --against main")
@click.argument("paths", metavar="[PATH]...", nargs=-1, type=EXISTING)
@click.option(
    "--against",
    metavar="REF",
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
@click.option("--system", is_flag=True, help="Compare two manifests of a system, the older one first.")
@include_option
@format_option
@quiet_option
def breaking(
    paths: tuple[Path, ...],
    against: str | None,
    category: str | None,
    allow_no_commit: bool,
    system: bool,
    include: tuple[Path, ...],
    format_: str,
    quiet: bool,
) -> int:
    """Look for changes that break other programs.

    Compares interfaces and node descriptions with their earlier version REF. Nothing is checked out.

    \b
    wire    bytes change their meaning: recorded data, and peers on any middleware
    hash    the type hash changes: peers on rmw_zenoh or Kilted no longer match.
            Includes wire.
    source  Python code no longer works. Includes hash and wire.

    A unit, a range or a frame that changed in a comment is a warning.

    PATH is as for `ifgen check`. Exits with 1 if a change breaks the category. `ifgen rules` lists the rules,
    which `ignore` and `per_file_ignores` in [tool.ifgen] and comments silence as they do warnings.

    With --system, PATH is two manifests, OLD and NEW, which `ifgen check --system --lock` writes: each change
    of what they provide and require is patch, minor or major. Exits with 1 if one is major.
    """  # noqa: D301 - the backspace is for click, which keeps the lines after it as they are
    from ifgen.reading import revisions

    if system:
        if len(paths) != 2 or against or category:
            message = "--system compares two manifests: OLD and NEW"
            raise click.UsageError(message, click.get_current_context())
        code: int = extension("breaking")(*paths, format_, quiet=quiet)
        return code
    if against is None:
        raise click.UsageError("Missing option '--against'.", click.get_current_context())
    settings = settle(paths, None, include).with_paths()
    if allow_no_commit and revisions.has_no_commit(Path.cwd()):
        return 0
    with without_garbage_collection():
        return _compared(settings, against, category, format_, quiet)


def _compared(settings: Settings, against: str, category: str | None, format_: str, quiet: bool) -> int:
    from ifgen.evolution import version
    from ifgen.evolution.edits import Category

    base = settings.file.parent if settings.file is not None else Path.cwd()
    new = version.current(settings.paths, settings.include)
    old = version.earlier(against, settings.paths, settings.include, base, new)
    chosen = Category(category or settings.config.breaking)
    found = [*new.mistakes, *_broken(old, new, chosen, settings.policy)]
    found += (replace(mistake, severity="warning") for mistake in old.mistakes)
    counts = ((len(new.interfaces), "interface"), (len(new.nodes or ()), "node"))
    what = " and ".join(terminal.counted(number, noun) for number, noun in counts if number) or "nothing"
    return terminal.print_findings(
        found, format_, "" if quiet else f"{what}: no change since {against} breaks {chosen}"
    )


def _broken(old: Version, new: Version, category: Category, policy: Policy) -> list[Diagnostic]:
    """The changes that break a category, as errors, and those of a meaning, without ignored ones."""
    from ifgen.evolution.compare import compare
    from ifgen.evolution.edit_diagnostics import diagnostic
    from ifgen.evolution.edits import MeaningChanged
    from ifgen.evolution.rules import is_broken

    differences = (
        d for d in compare(old, new) if is_broken(category, d.edit) or isinstance(d.edit, MeaningChanged)
    )
    found = map(diagnostic, differences)
    told = _without_ignored(d for d in found if d is not None and not policy.silences(d))
    return sorted((replace(d, severity="error") if d.breaks else d for d in told), key=_place)


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


@click.command(epilog="Example: ifgen diff main:demo_msgs/msg/Pose")
@click.argument("a", metavar="A", shell_complete=completion.types)
@click.argument("b", metavar="[B]", required=False, shell_complete=completion.types)
@include_option
def diff(a: str, b: str | None, include: tuple[Path, ...]) -> int:
    """Show two versions of a type side by side.

    \b
    A and B are each one of
      TYPE      a name such as demo_msgs/msg/Pose, or a package
      REF:TYPE  the same of a git revision, a folder or a lock file
      PATH      an interface file, a folder or a lock file

    Without B, it compares REF:TYPE with TYPE as it is now. Of packages and folders, it shows only the types
    that differ. Exits with 1 if there is a difference.
    """  # noqa: D301 - the backspace is for click, which keeps the lines after it as they are
    from ifgen.evolution import selection

    settings = settle(None, None, include)
    left = selection.select(a, settings.paths, settings.include)
    right = selection.select(b if b is not None else _type_in(a), settings.paths, settings.include)
    differing = [
        pair for pair in selection.pairs(left, right) if _lines(pair[0], left) != _lines(pair[1], right)
    ]
    if not differing:
        print(f"{left.label} and {right.label} do not differ")
        return 0
    terminal.print_text(_shown(differing, left, right))
    return 1


def _type_in(a: str) -> str:
    from ifgen.evolution.selection import split

    reference, type_name = split(a)
    if reference is None:
        message = f"there is nothing to compare '{a}' with"
        advice = "name a second version, or an earlier one as REF:TYPE"
        raise UsageError([Diagnostic("unknown-type", message, help=advice)])
    return type_name


def _shown(pairs: list[tuple[Interface | None, Interface | None]], left: Selection, right: Selection) -> Text:
    from rich.text import Text

    from ifgen.cli.evolution.side_by_side import rows

    width = shutil.get_terminal_size().columns
    text = Text()
    for number, (old, new) in enumerate(pairs):
        if number:
            text.append("\n")
        before, after = (_with_label(one, side) for one, side in ((old, left), (new, right)))
        for index, row in enumerate(rows(before, after, width, _HEAD)):
            text.append(f"{row.text}\n", row.style if index else "bold")
        for line in _changes(old, new, left.registry, right.registry):
            text.append(textwrap.fill(line, width, subsequent_indent="  ") + "\n")
    return text


def _with_label(interface: Interface | None, selection: Selection) -> list[str]:
    """The lines of one side below its label, with as much of the hash as tells it from others."""
    lines = _lines(interface, selection) or ["(no such type)", ""]
    return [selection.label, lines[0], f"{lines[1][:_HASH]}..." if lines[1] else "", *lines[2:]]


def _lines(interface: Interface | None, selection: Selection) -> list[str]:
    """The definition without comments, its nested types below their fields; empty if there is none."""
    from ifgen.cli import interface_text

    return [] if interface is None else list(interface_text.definition(interface, selection.registry))


def _changes(
    old: Interface | None, new: Interface | None, before: Registry, after: Registry
) -> Iterator[str]:
    """The rules of all edits, with the categories that they break."""
    from ifgen.evolution.compare import between
    from ifgen.evolution.edit_diagnostics import diagnostic

    if old is None or new is None:
        return
    found = [d for d in map(diagnostic, between(old, new, before, after)) if d is not None]
    if found:
        yield ""
    for change in found:
        yield f"{change.rule}: {change.message} (breaks {', '.join(change.breaks)})"

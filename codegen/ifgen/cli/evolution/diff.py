"""`ifgen diff`: two versions of a type, side by side."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from ifgen.command_kit import completion, terminal
from ifgen.command_kit.options import include_option
from ifgen.config.settings import settle
from ifgen.diagnostics import Diagnostic, UsageError

if TYPE_CHECKING:
    from rich.text import Text

    from ifgen.definition.interfaces import Interface, Registry
    from ifgen.evolution.selection import Selection

# Late imports: a request for help needs none of these.

_HEAD: Final = 3
"""Lines before a definition: where it is from, the name and the hash of the type."""

_HASH: Final = 23
"""Characters of a hash that fit into a column."""


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
    from ifgen.cli import show

    return [] if interface is None else list(show.definition(interface, selection.registry))


def _changes(
    old: Interface | None, new: Interface | None, before: Registry, after: Registry
) -> Iterator[str]:
    """The rules of all edits, with the categories that they break."""
    from ifgen.evolution.compare import between
    from ifgen.evolution.words import diagnostic

    if old is None or new is None:
        return
    found = [d for d in map(diagnostic, between(old, new, before, after)) if d is not None]
    if found:
        yield ""
    for change in found:
        yield f"{change.rule}: {change.message} (breaks {', '.join(change.breaks)})"

"""Diagnostics about the output folder, besides mistakes in the input."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from ifgen.diagnostics import Diagnostic, shown_path
from ifgen.reading.packages import PackageFiles
from ifgen.writing.write import EDITED, set_aside


def into_its_source(package: PackageFiles) -> Diagnostic:
    """Refuse to generate a package into its own source."""
    message = f"package '{package.name}' would be generated into its own source, {shown_path(package.root)}"
    advice = "choose another folder with -o, or with `output` in [tool.ifgen]"
    return Diagnostic("output-is-source", message, help=advice)


def left_behind(path: Path) -> Diagnostic:
    """Tell of a module of the user's whose node is gone."""
    message = f"{shown_path(path)} is yours, but no node uses it any more: it stays"
    return Diagnostic(
        "left-behind", message, help="delete it, or move it to where it is used", severity="warning"
    )


def edited(path: Path) -> Diagnostic:
    """Tell of a file that is generated no longer, and was not deleted because it was edited."""
    message = f"{shown_path(path)} is no longer generated, but was edited: it stays"
    return Diagnostic("edited-file", message, help="delete it, or move it elsewhere", severity="warning")


def overwritten(paths: Sequence[Path], output: Path) -> Iterator[Diagnostic]:
    """Tell of generated files that were edited, and where those are now."""
    if paths:
        first, others = shown_path(paths[0]), len(paths) - 1
        which = (
            f"{first} was"
            if not others
            else f"{first} and {others} more generated file{'s' * (others > 1)} were"
        )
        kept = output / EDITED if others else set_aside(paths[0], output)
        advice = f"your version is in {shown_path(kept)}; put your code into your node module or a template"
        message = f"{which} edited, and generated again"
        yield Diagnostic("edited-file", message, help=advice, severity="warning")

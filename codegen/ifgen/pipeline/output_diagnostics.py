"""Diagnostics about the output folder: files in it, and what it will lack at run time."""

from __future__ import annotations

import importlib.machinery
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path

from ifgen import resources
from ifgen.diagnostics import Diagnostic, shown_path
from ifgen.pipeline.previous_output import manifest_of
from ifgen.reading.packages import PackageFiles
from ifgen.reading.search_path import SearchPath
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


def missing_packages(
    needed: Iterable[str], search: SearchPath, output: Path, removed: Collection[str]
) -> Iterator[Diagnostic]:
    """Say which packages are needed, come out of folders of the user's, and will not be there at run time.

    `needed` are those that this run does not generate, `removed` those that it removes from `output`.
    Packages that are installed, or come with ifgen, have their own Python.
    """
    for name in sorted(needed):
        package = search.package(name)
        if package is not None and search.is_own(name) and not _is_there(name, output, removed):
            yield Diagnostic(
                "not-generated",
                f"nothing provides package '{name}' at run time: it is needed, but not generated",
                help=f"generate it too: name {shown_path(package.root)} as a PATH, or use --with-deps=own",
                severity="warning",
            )


def _is_there(name: str, output: Path, removed: Collection[str]) -> bool:
    return (
        (name not in removed and manifest_of(output / name) is not None)
        or (resources.bundled_generated() / name).is_dir()
        or importlib.machinery.PathFinder.find_spec(name, sys.path) is not None
    )

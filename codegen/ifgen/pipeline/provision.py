"""Whether somebody provides what generated packages import."""

from __future__ import annotations

import importlib.machinery
import sys
from collections.abc import Collection, Iterable
from pathlib import Path

from ifgen import resources
from ifgen.diagnostics import Diagnostic, shown_path
from ifgen.pipeline.earlier import record_of
from ifgen.reading.search_path import SearchPath


def missing(
    needed: Iterable[str], search: SearchPath, output: Path, going: Collection[str]
) -> tuple[Diagnostic, ...]:
    """Say which packages are needed, come out of folders of the user's, and will not be there at run time.

    `needed` are those that this run does not generate, `going` those that it removes from `output`. Packages
    that are installed, or come with ifgen, have their own Python.
    """
    own = (name for name in sorted(needed) if search.is_own(name))
    return tuple(_missing(name, search) for name in own if not _is_there(name, output, name in going))


def _missing(name: str, search: SearchPath) -> Diagnostic:
    package = search.package(name)
    assert package is not None
    return Diagnostic(
        "not-generated",
        f"nothing provides package '{name}' at run time: it is needed, but not generated",
        help=f"generate it too: name {shown_path(package.root)} as a PATH, or use --with-deps=own",
        severity="warning",
    )


def _is_there(name: str, output: Path, is_going: bool) -> bool:
    return (
        (not is_going and record_of(output / name) is not None)
        or (resources.bundled_generated() / name).is_dir()
        or importlib.machinery.PathFinder.find_spec(name, sys.path) is not None
    )

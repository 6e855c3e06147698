"""The output folder as earlier runs left it: which of its packages have to go, and diagnostics about it."""

from __future__ import annotations

import importlib.machinery
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ifgen import resources
from ifgen.diagnostics import Diagnostic, shown_path
from ifgen.pipeline.values import BuildResult, Request
from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.writing.write import EDITED, ROOT, set_aside


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
    needed: Iterable[str], request: Request, removed: Collection[str]
) -> Iterator[Diagnostic]:
    """Say which packages are needed, come out of folders of the user's, and will not be there at run time.

    `needed` are those that this run does not generate, `removed` those that it removes from the output.
    Packages that are installed, or come with ifgen, have their own Python.
    """
    for name in sorted(needed):
        package = request.search.package(name)
        is_there = name in request.previous.keys() - removed or _is_installed(name)
        if package is not None and request.search.is_own(name) and not is_there:
            yield Diagnostic(
                "not-generated",
                f"nothing provides package '{name}' at run time: it is needed, but not generated",
                help=f"generate it too: name {shown_path(package.root)} as a PATH, or use --with-deps=own",
                severity="warning",
            )


def _is_installed(name: str) -> bool:
    return (resources.bundled_generated() / name).is_dir() or importlib.machinery.PathFinder.find_spec(
        name, sys.path
    ) is not None


def manifests_in(output: Path) -> dict[str, Manifest]:
    """The readable manifests of generated packages, by name; write.py complains about the others."""
    found: dict[str, Manifest] = {}
    for folder in (output / ROOT, *output.iterdir()) if output.is_dir() else ():
        with suppress(OSError, ValueError):
            if (read := manifest.read(folder)) is not None:
                found[folder.name if folder != output else ROOT] = read
    return found


def with_siblings(package: PackageFiles, previous: Mapping[str, Manifest]) -> PackageFiles:
    """Add the files of a package that earlier runs generated, if a single file adds to that package."""
    found = previous.get(package.name) if package.partial else None
    if found is None:
        return package
    earlier = (package.interface(*name.split("/", 1)) for name in found.interfaces if "/" in name)
    files = dict.fromkeys((*package.files, *(file for file in earlier if file is not None)))
    described = {f"{NODE_FOLDER}/{node.name}" for node in package.nodes} | set(found.interfaces)
    nodes = (node for node in package.known_nodes() if f"{NODE_FOLDER}/{node.name}" in described)
    return replace(package, files=tuple(files), nodes=tuple(nodes))


def to_remove(request: Request, result: BuildResult) -> list[str]:
    """The packages of earlier runs that are left out now, or that nothing generates any more.

    Their folder in the paths of the request is gone, or is another package now; or they were dependencies of
    what this run generates without them. While there are packages that this run is not about, they may need
    those.
    """
    asked = {package.name for package in request.packages}
    names = (*request.excluded, *(left_out.name for left_out in result.left_out))
    left_out = {name for name in names if "/" not in name} | asked.difference(result.generated)
    moved = {package.root.resolve() for package in request.packages}
    roots = [path.resolve() for path in request.paths]
    abandoned: set[str] = set()
    dependencies: set[str] = set()
    may_need_them = False
    for name in request.previous.keys() - {*asked, *result.generated, ROOT}:
        source = request.previous[name].source_folder(request.output.resolve())
        if source is None:
            dependencies.add(name)
        elif source in moved or (not source.exists() and any(root in source.parents for root in roots)):
            abandoned.add(name)
        else:
            may_need_them = True
    if not may_need_them:
        abandoned |= dependencies
    return sorted(abandoned | (left_out & request.previous.keys()))

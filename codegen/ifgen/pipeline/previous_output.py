"""The packages that earlier runs left in the output folder: what is in them, and which of them have to go."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ifgen.pipeline.values import BuildResult, Request
from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.writing.write import ROOT


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

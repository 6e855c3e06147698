"""The packages that earlier runs left in the output folder: what is in them, and which of them have to go."""

from __future__ import annotations

import os
from collections.abc import Set
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ifgen.pipeline.values import BuildResult, Request
from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles


def manifest_of(folder: Path) -> Manifest | None:
    """The manifest of a generated package, if it has a readable one; write.py complains about the others."""
    try:
        return manifest.read(folder)
    except (OSError, ValueError):
        return None


def digest_of(folder: Path) -> str:
    """The digest of the manifest of a generated package; empty if it has none."""
    found = manifest_of(folder)
    return found.digest if found is not None else ""


def packages_in(output: Path) -> Set[str]:
    """The packages that ifgen has generated into a folder."""
    folders = output.iterdir() if output.is_dir() else ()
    return {folder.name for folder in folders if manifest_of(folder) is not None}


def source_of(package: PackageFiles, output: Path) -> str:
    """The folder of a package that was asked for, seen from the output folder."""
    root = package.root.resolve()
    with suppress(ValueError):  # on another drive
        return Path(os.path.relpath(root, output.resolve())).as_posix()
    return root.as_posix()


def with_siblings(package: PackageFiles, output: Path) -> PackageFiles:
    """Add the files of a package that earlier runs generated, if a single file adds to that package."""
    found = manifest_of(output / package.name) if package.partial else None
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
    output, asked = request.output, {package.name for package in request.packages}
    names = (*request.excluded, *(left_out.name for left_out in result.left_out))
    left_out = {name for name in names if "/" not in name} | asked.difference(result.generated)
    others = asked.union(result.generated) - left_out
    folders = [f for f in output.iterdir() if f.name not in others] if output.is_dir() else []
    manifests = {folder.name: found for folder in folders if (found := manifest_of(folder)) is not None}
    moved = {package.root.resolve() for package in request.packages}
    roots = [path.resolve() for path in request.paths]
    abandoned: set[str] = set()
    dependencies: set[str] = set()
    may_need_them = False
    for name in manifests.keys() - asked:
        source = manifests[name].source_folder(output.resolve())
        if source is None:
            dependencies.add(name)
        elif source in moved or (not source.exists() and any(root in source.parents for root in roots)):
            abandoned.add(name)
        else:
            may_need_them = True
    if not may_need_them:
        abandoned |= dependencies
    return sorted(abandoned | (left_out & manifests.keys()))

"""Results of earlier runs in the output folder: packages that single files add to, and those to remove."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ifgen.reading import manifest
from ifgen.reading.manifest import Manifest
from ifgen.reading.packages import NODE_FOLDER, PackageFiles
from ifgen.writing.write import OutputPackage


def with_siblings(package: PackageFiles, output: Path) -> PackageFiles:
    """Add the files of a package that earlier runs generated, if a single file adds to that package."""
    record = record_of(output / package.name) if package.partial else None
    if record is None:
        return package
    earlier = (package.interface(*name.split("/", 1)) for name in record.interfaces if "/" in name)
    files = dict.fromkeys((*package.files, *(file for file in earlier if file is not None)))
    described = {f"{NODE_FOLDER}/{node.name}" for node in package.nodes} | set(record.interfaces)
    nodes = (node for node in package.known_nodes() if f"{NODE_FOLDER}/{node.name}" in described)
    return replace(package, files=tuple(files), nodes=tuple(nodes))


def gone(
    paths: Sequence[Path | str],
    packages: Sequence[PackageFiles],
    generated: Collection[str],
    output: Path,
) -> Iterator[OutputPackage]:
    """Packages of earlier runs that nothing generates any more; `generated` are those of this run.

    Their folder in `paths` is gone, or is another package now; or they were dependencies of what this run
    generates without them. While there are packages that this run is not about, they may need those.
    """
    covered = {package.name for package in packages} | set(generated)
    folders = sorted(output.iterdir()) if output.is_dir() else []
    others = (folder for folder in folders if folder.name not in covered)
    records = {folder.name: record for folder in others if (record := record_of(folder)) is not None}
    renamed = {package.root.resolve() for package in packages}
    roots = [Path(path).resolve() for path in paths]
    left: list[str] = []
    dependencies: list[str] = []
    may_need_them = False
    for name, record in records.items():
        source = record.source_folder(output.resolve())
        if source is None:
            dependencies.append(name)
        elif source in renamed or (not source.exists() and any(root in source.parents for root in roots)):
            left.append(name)
        else:
            may_need_them = True
    for name in sorted(left if may_need_them else [*left, *dependencies]):
        yield OutputPackage(name, {})


def packages_in(output: Path) -> set[str]:
    """The packages that ifgen has generated into a folder."""
    folders = output.iterdir() if output.is_dir() else ()
    return {folder.name for folder in folders if record_of(folder) is not None}


def source_of(package: PackageFiles, output: Path) -> str:
    """The folder of a package that was asked for, seen from the output folder."""
    root = package.root.resolve()
    with suppress(ValueError):  # on another drive
        return Path(os.path.relpath(root, output.resolve())).as_posix()
    return root.as_posix()


def record_of(folder: Path) -> Manifest | None:
    """The manifest of a generated package, if it has a readable one; write.py complains about the others."""
    try:
        return manifest.read(folder)
    except (OSError, ValueError):
        return None

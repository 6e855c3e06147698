"""Finds packages with interfaces or nodes, and their files: the only place that looks for input."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from ifgen.diagnostics import Diagnostic, InputError
from ifgen.reading import interface_list, manifest, package_xml, storage
from ifgen.reading.interface_list import InterfaceList
from ifgen.reading.listed_file import EXTENSIONS
from ifgen.reading.package_files import (
    FOLDERS,
    IDL,
    NODE_EXTENSIONS,
    NODE_FOLDER,
    Contents,
    InterfaceFile,
    NodeFile,
    PackageFiles,
    contents,
    folder_of,
    interface_paths,
    is_adapted,
    node_name,
    nodes_below,
)
from ifgen.reading.storage import unreadable

__all__ = [
    "FOLDERS",
    "IDL",
    "NODE_EXTENSIONS",
    "NODE_FOLDER",
    "InterfaceFile",
    "NodeFile",
    "PackageFiles",
    "find_packages",
    "find_what_can_be",
    "is_adapted",
    "node_name",
]

_IGNORE_MARKERS: Final = ("COLCON_IGNORE", "AMENT_IGNORE")
_BUILD_FOLDERS: Final = ("build", "install", "log")


def find_packages(paths: Iterable[Path | str]) -> tuple[PackageFiles, ...]:
    """Find the packages with interfaces or nodes that paths stand for, sorted by name.

    A path is a package's folder, a folder that holds packages at any depth, or a single file, which stands
    for its package with just that file. InputError with every path that cannot be read or leads to no
    interface.
    """
    packages, problems = find_what_can_be(paths)
    if problems:
        raise InputError(problems)
    return packages


def find_what_can_be(paths: Iterable[Path | str]) -> tuple[tuple[PackageFiles, ...], list[Diagnostic]]:
    """The same, where something is wrong perhaps, and the mistakes."""
    found: dict[str, list[PackageFiles]] = {}
    problems: list[Diagnostic] = []
    for path in map(Path, paths):
        known_problems = len(problems)
        try:
            packages = list(packages_at(path, problems))
        except OSError as error:
            problems.append(unreadable(path, error))
            continue
        if not packages and len(problems) == known_problems:
            problems.append(_nothing_found(path))
        for package in packages:
            found.setdefault(package.name, []).append(package)
    return tuple(_merged(found[name]) for name in sorted(found)), problems


def packages_at(path: Path, problems: list[Diagnostic]) -> Iterator[PackageFiles]:
    """The packages of one path. Adds to `problems`, and raises OSError if nothing is there."""
    folder = path.absolute()
    if not storage.leads_to_folder(path):
        yield from _package_of_files([path], problems)
    elif folder.name in FOLDERS and (paths := interface_paths(folder)):
        yield from _package_of_files(paths, problems, folder)
    elif folder.name == NODE_FOLDER and (nodes := nodes_below(folder.parent)):
        yield from _package_of_files([node.path for node in nodes], problems)
    else:
        found = list(_packages_below(path, set(), problems))
        yield from found or _package_of_files([], problems, folder)


def _package_of_files(
    paths: Sequence[Path], problems: list[Diagnostic], folder: Path | None = None
) -> Iterator[PackageFiles]:
    """The package of files from one folder; one outside a package's folders counts as if in one.

    With `folder`, that was asked for as a whole: of a package with a list it is what that has there.
    """
    place = folder or paths[0].absolute().parent
    in_place = place.name in (*FOLDERS, NODE_FOLDER)
    root = _root_around(place)
    if in_place and root != place.parent:
        known = contents(root).files if root else ()
        if not any(place in file.path.absolute().parents for file in known):
            root = place.parent  # a package without package.xml, within another one perhaps
    root = root or place
    known, _, listed = contents(root)
    by_path = {os.path.realpath(file.path): file for file in known}
    nodes = tuple(NodeFile(path) for path in paths if node_name(path.name) is not None)
    files = [
        by_path.get(os.path.realpath(path))
        or InterfaceFile(path, place.name if in_place else folder_of(path))
        for path in paths
        if path.suffix in EXTENSIONS
    ]
    if folder is not None and listed is not None:
        files = [file for file in known if folder in file.path.absolute().parents]
    if listed is not None:
        others = [file.path for file in files if os.path.realpath(file.path) not in by_path]
        listed = replace(listed, diagnostics=interface_list.asked_for_all_the_same(root, others, listed))
    if files or nodes:
        yield _package(root, tuple(files), nodes, listed, problems, partial=True)


def _root_around(place: Path) -> Path | None:
    """The nearest folder upwards with a package.xml."""
    return next(
        (folder for folder in (place, *place.parents) if storage.is_file(folder / package_xml.NAME)), None
    )


def _packages_below(folder: Path, seen: set[object], problems: list[Diagnostic]) -> Iterator[PackageFiles]:
    """Look into a folder and, unless it is a package, into those that it holds; links lead nowhere twice."""
    try:
        identity = storage.identity(folder)
        names = {entry.name: entry.is_folder for entry in storage.entries(folder)}
        is_ignored = bool(seen) and not names.keys().isdisjoint(_IGNORE_MARKERS)
        if is_ignored or identity in seen:
            return
        seen.add(identity)
        if manifest.NAME in names and manifest.is_generated(folder):
            return
        may_be_a_package = not names.keys().isdisjoint((package_xml.NAME, *FOLDERS, NODE_FOLDER))
        files, nodes, listed = contents(folder) if may_be_a_package else Contents()
    except OSError as error:
        problems.append(unreadable(folder, error))
        return
    if files or nodes or (listed and listed.is_wrong):
        yield _package(folder, files, nodes, listed, problems)
        return
    for name in sorted(names):
        if names[name] and not name.startswith(".") and name not in _BUILD_FOLDERS:
            yield from _packages_below(folder / name, seen, problems)


def _package(
    root: Path,
    files: tuple[InterfaceFile, ...],
    nodes: tuple[NodeFile, ...],
    listed: InterfaceList | None,
    problems: list[Diagnostic],
    partial: bool = False,
) -> PackageFiles:
    """The package, with the name in its package.xml, else the name of its folder."""
    xml = package_xml.read(root, problems)
    return PackageFiles((xml and xml.name) or root.resolve().name, root, files, partial, xml, nodes, listed)


def _merged(packages: Sequence[PackageFiles]) -> PackageFiles:
    """One package of several finds of the same name, each file once."""
    if len(packages) == 1:
        return packages[0]
    files = {file.path.resolve(): file for package in packages for file in package.files}
    nodes = {node.path.resolve(): node for package in packages for node in package.nodes}
    whole = next((package for package in packages if not package.partial), packages[0])
    return replace(whole, files=tuple(files.values()), nodes=tuple(nodes.values()))


def _nothing_found(path: Path) -> Diagnostic:
    if manifest.is_generated(path):
        message = f"{path} is a package that ifgen generated, not a source of interfaces"
        return Diagnostic("no-interfaces", message, help="name the folder that it was generated from")
    if path.suffix in {".json", ".yaml", ".yml"}:
        message = f"{path} is not an interface file"
        advice = f"if it describes a node, call it {path.stem}.nodl{path.suffix}"
        return Diagnostic("no-interfaces", message, help=advice)
    return Diagnostic(
        "no-interfaces",
        f"no interface files in {path}",
        help="a package keeps them in folders named msg, srv and action: PACKAGE/msg/Name.msg; and the "
        "descriptions of its nodes in PACKAGE/nodl/name.nodl.yaml",
    )

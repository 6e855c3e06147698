"""Finds packages with interfaces or nodes, and their files: the only place that looks for input."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Final

from ifgen import resources
from ifgen.diagnostics import Diagnostic, InterfaceError, Source, Span
from ifgen.package_xml import declared_name
from ifgen.text_files import read_source, unreadable

FOLDERS: Final = ("action", "msg", "srv")
"""Where a package keeps its interfaces; an interface file's extension is the name of its folder."""

NODE_FOLDER: Final = "nodl"
"""Where a package keeps the descriptions of its nodes."""

NODE_EXTENSIONS: Final = (".nodl.json", ".nodl.yaml", ".nodl.yml")

_EXTENSIONS: Final = (".action", ".msg", ".srv")
_PARTS: Final = ("Request", "Response", "Event", "Goal", "Result", "Feedback")
_IGNORE_MARKERS: Final = ("COLCON_IGNORE", "AMENT_IGNORE")
_BUILD_FOLDERS: Final = ("build", "install", "log")
_MAX_FILE_NAME: Final = 255  # bytes, on all systems; names of packages are ASCII


@dataclass(frozen=True, slots=True)
class InterfaceFile:
    """`package/folder/name`, with the extension that its kind has; `folder` is where the file really is."""

    path: Path
    folder: str

    @property
    def kind(self) -> str:
        """The extension: `msg`, `srv` or `action`."""
        return self.path.suffix[1:]

    @property
    def name(self) -> str:
        """The name of the interface."""
        return self.path.stem

    def read(self) -> Source:
        """The text of the file, with plain line ends; InterfaceError if it cannot be read or is not UTF-8."""
        return read_source(self.path)


@dataclass(frozen=True, slots=True)
class NodeFile:
    """The description of a node: `package/nodl/name.nodl.yaml`, `.nodl.yml` or `.nodl.json`."""

    path: Path

    @property
    def name(self) -> str:
        """The name of the node."""
        return node_name(self.path.name) or self.path.name

    def read(self) -> Source:
        """The text of the file, with plain line ends; InterfaceError if it cannot be read or is not UTF-8."""
        return read_source(self.path)


def node_name(file_name: str) -> str | None:
    """The node that a file with this name describes; None if its extension is another."""
    for extension in NODE_EXTENSIONS:
        if file_name.endswith(extension):
            return file_name.removesuffix(extension)
    return None


@dataclass(frozen=True)
class PackageFiles:
    """A package with interfaces, descriptions of nodes or both, and the files of it that were asked for.

    `root` is its folder; `declared` is where its package.xml names it, if it has one. A package that stands
    for single files has `partial` set: it can find its other files too.
    """

    name: str
    root: Path
    files: tuple[InterfaceFile, ...]
    partial: bool = False
    declared: Span | None = field(default=None, compare=False, repr=False)
    nodes: tuple[NodeFile, ...] = ()

    @cached_property
    def _on_disk(self) -> Mapping[tuple[str, str], InterfaceFile]:
        known = {(file.folder, file.name): file for file in _files_below(self.root)} if self.partial else {}
        known.update(((file.folder, file.name), file) for file in self.files)
        return known

    def find(self, folder: str, name: str) -> InterfaceFile | None:
        """The file of an interface; None if there is none."""
        return self._on_disk.get((folder, name))

    def known_files(self) -> list[InterfaceFile]:
        """All its files, those on disk that were not asked for included."""
        return list(self._on_disk.values())

    def names(self, folder: str) -> list[str]:
        """The interfaces in one of its folders."""
        return [name for known_folder, name in self._on_disk if known_folder == folder]

    def known_nodes(self) -> list[NodeFile]:
        """The descriptions of all its nodes, those on disk that were not asked for included."""
        return (
            list(dict.fromkeys((*self.nodes, *_nodes_below(self.root)))) if self.partial else list(self.nodes)
        )


def find_packages(paths: Iterable[Path | str]) -> tuple[PackageFiles, ...]:
    """Find the packages with interfaces or nodes that paths stand for, sorted by name.

    A path is a package's folder, a folder that holds packages at any depth, or a single file, which stands
    for its package with just that file. InterfaceError with every path that cannot be read or leads to no
    interface.
    """
    found: dict[str, list[PackageFiles]] = {}
    problems: list[Diagnostic] = []
    for path in map(Path, paths):
        known_problems = len(problems)
        try:
            packages = list(_packages_at(path, problems))
        except OSError as error:
            problems.append(unreadable(path, error))
            continue
        if not packages and len(problems) == known_problems:
            problems.append(_nothing_found(path))
        for package in packages:
            found.setdefault(package.name, []).append(package)
    if problems:
        raise InterfaceError(problems)
    return tuple(_merged(found[name]) for name in sorted(found))


class SearchPath:
    """Finds the packages that others depend on, by name and only when asked.

    In this order: the packages given, the folders to include, AMENT_PREFIX_PATH, the interpreter's own
    `share` folder (where the ros-* wheels put theirs), and the packages that come with ifgen. InterfaceError
    if one of the folders to include does not exist.
    """

    def __init__(self, given: Sequence[PackageFiles] = (), include: Sequence[Path | str] = ()) -> None:
        self._known: dict[str, PackageFiles | None] = {package.name: package for package in given}
        self._include = [Path(path) for path in include]
        missing = [path for path in self._include if not path.exists()]
        if missing:
            raise InterfaceError(
                Diagnostic("unreadable-path", f"there is no {path} to include") for path in missing
            )

    def find(self, name: str) -> PackageFiles | None:
        """The package of this name; None if it is nowhere."""
        if len(name) > _MAX_FILE_NAME:
            return None
        if name not in self._known:
            self._known[name] = self._look_for(name)
        return self._known[name]

    def find_node(self, package_name: str, name: str) -> NodeFile | None:
        """The NoDL document `nodl://package/name`: of a package that `find` finds, or in the ament index."""
        package = self.find(package_name)
        for node in package.known_nodes() if package else ():
            if node.name == name:
                return node
        key = f"{package_name}__{name}"
        if "/" in key or len(key) > _MAX_FILE_NAME:
            return None
        indexes = (share / "ament_index" / "resource_index" / "nodl" / key for share in self._shares)
        return next((NodeFile(path) for path in indexes if path.is_file()), None)

    def places(self) -> list[str]:
        """Where it looks besides the given packages, in order."""
        return [str(path) for path in (*self._include, *self._shares)]

    def package_names(self) -> list[str]:
        """The names of all packages with interfaces that can be found."""
        found = (
            (name, package) for known in (self._known, self._included) for name, package in known.items()
        )
        names = {name for name, package in found if package and package.known_files()}
        for share in self._shares:
            if share.is_dir():
                names.update(path.name for path in share.iterdir() if _files_below(path))
        return sorted(names)

    def packages_with(self, interface: str, folder: str = "msg") -> list[str]:
        """The names of all packages that have an interface of this name in a folder."""
        return [
            name
            for name in self.package_names()
            if (package := self.find(name)) and package.find(folder, interface)
        ]

    def _look_for(self, name: str) -> PackageFiles | None:
        if name in self._included:
            return self._included[name]
        for share in self._shares:
            files, nodes = _files_below(share / name), _nodes_below(share / name)
            if files or nodes:
                return PackageFiles(name, share / name, files, nodes=nodes)
        return None

    @cached_property
    def _included(self) -> Mapping[str, PackageFiles]:
        included: dict[str, PackageFiles] = {}
        for path in self._include:
            # What is wrong with a package.xml does not matter to those who look for another package.
            for package in _packages_at(path, []):
                included.setdefault(package.name, package)
        return included

    @cached_property
    def _shares(self) -> Sequence[Path]:
        prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
        shares = [Path(prefix) / "share" for prefix in (*prefixes, sys.prefix)]
        return [*shares, resources.bundled_interfaces()]


def _packages_at(path: Path, problems: list[Diagnostic]) -> Iterator[PackageFiles]:
    if path.is_file():
        yield from _package_of_files([path], problems)
    elif path.absolute().name in FOLDERS and (paths := _interface_paths(path.absolute())):
        yield from _package_of_files(paths, problems)
    elif path.absolute().name == NODE_FOLDER and (nodes := _nodes_below(path.absolute().parent)):
        yield from _package_of_files([node.path for node in nodes], problems)
    else:
        yield from _packages_below(path, set(), problems)


def _package_of_files(paths: Sequence[Path], problems: list[Diagnostic]) -> Iterator[PackageFiles]:
    """The package of files from one folder; one outside a package's folders counts as if in one."""
    folder = paths[0].absolute().parent
    in_place = folder.name in (*FOLDERS, NODE_FOLDER)
    nodes = tuple(NodeFile(path) for path in paths if node_name(path.name) is not None)
    interfaces = (path for path in paths if path.suffix in _EXTENSIONS)
    files = tuple(InterfaceFile(path, folder.name if in_place else path.suffix[1:]) for path in interfaces)
    if files or nodes:
        yield _package(folder.parent if in_place else folder, files, nodes, True, problems)


def _packages_below(
    folder: Path, seen: set[tuple[int, int]], problems: list[Diagnostic]
) -> Iterator[PackageFiles]:
    """Look into a folder and, unless it is a package, into those that it holds; links lead nowhere twice."""
    try:
        status = folder.stat()
        names = {entry.name: entry.is_dir() for entry in os.scandir(folder)}
        files = () if names.keys().isdisjoint(FOLDERS) else _files_below(folder)
        nodes = _nodes_below(folder) if NODE_FOLDER in names else ()
    except OSError as error:
        problems.append(unreadable(folder, error))
        return
    is_ignored = bool(seen) and not names.keys().isdisjoint(_IGNORE_MARKERS)
    if is_ignored or (status.st_dev, status.st_ino) in seen:
        return
    seen.add((status.st_dev, status.st_ino))
    if files or nodes:
        yield _package(folder, files, nodes, False, problems)
        return
    for name in sorted(names):
        if names[name] and not name.startswith(".") and name not in _BUILD_FOLDERS:
            yield from _packages_below(folder / name, seen, problems)


def _files_below(root: Path) -> tuple[InterfaceFile, ...]:
    return tuple(
        InterfaceFile(path, folder) for folder in FOLDERS for path in _interface_paths(root / folder)
    )


def _nodes_below(root: Path) -> tuple[NodeFile, ...]:
    folder = root / NODE_FOLDER
    try:
        with os.scandir(folder) as entries:
            names = sorted(entry.name for entry in entries if not entry.name.startswith("."))
    except (FileNotFoundError, NotADirectoryError):
        return ()
    return tuple(NodeFile(folder / name) for name in names if node_name(name) is not None)


def _interface_paths(folder: Path) -> list[Path]:
    """The interface files in a folder, without the parts of services that ROS installs beside them."""
    try:
        with os.scandir(folder) as entries:
            names = {entry.name for entry in entries if entry.name.endswith(_EXTENSIONS)}
    except (FileNotFoundError, NotADirectoryError):
        return []
    return [
        folder / name
        for name in sorted(names)
        if not name.startswith(".") and not _is_part(name, folder, names)
    ]


def _is_part(name: str, folder: Path, names: Set[str]) -> bool:
    """Whether a file such as srv/SetBool_Request.msg was made from the service or action beside it."""
    whole, _, part = name.removesuffix(".msg").rpartition("_")
    return folder.name != "msg" and part in _PARTS and f"{whole}.{folder.name}" in names


def _package(
    root: Path,
    files: tuple[InterfaceFile, ...],
    nodes: tuple[NodeFile, ...],
    partial: bool,
    problems: list[Diagnostic],
) -> PackageFiles:
    """The package with the name that package.xml says, else that of its folder."""
    declared = declared_name(root, problems)
    name, span = declared or ("", None)
    return PackageFiles(name or root.resolve().name, root, files, partial, span, nodes)


def _merged(packages: Sequence[PackageFiles]) -> PackageFiles:
    """One package of several finds of the same name, each file once."""
    if len(packages) == 1:
        return packages[0]
    files = {file.path.resolve(): file for package in packages for file in package.files}
    nodes = {node.path.resolve(): node for package in packages for node in package.nodes}
    whole = next((package for package in packages if not package.partial), packages[0])
    return replace(whole, files=tuple(files.values()), nodes=tuple(nodes.values()))


def _nothing_found(path: Path) -> Diagnostic:
    return Diagnostic(
        "no-interfaces",
        f"no interface files in {path}",
        help="a package keeps them in folders named msg, srv and action: PACKAGE/msg/Name.msg; and the "
        "descriptions of its nodes in PACKAGE/nodl/name.nodl.yaml",
    )

"""Finds packages with interfaces or nodes, and their files: the only place that looks for input."""

from __future__ import annotations

import os
import stat
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Final, Literal

from ifgen import interface_list, manifest, package_xml, resources
from ifgen.diagnostics import Diagnostic, InterfaceError, Source, Span
from ifgen.interface_list import PARTS, InterfaceList
from ifgen.listed_file import EXTENSIONS
from ifgen.package_xml import PackageXml
from ifgen.text_files import read_source, unreadable

FOLDERS: Final = ("action", "msg", "srv")
"""Where a package keeps its interfaces; an interface file's extension is the name of its folder, or idl."""

NODE_FOLDER: Final = "nodl"
"""Where a package keeps the descriptions of its nodes."""

NODE_EXTENSIONS: Final = (".nodl.json", ".nodl.yaml", ".nodl.yml")

IDL: Final = ".idl"
"""The extension of interfaces in OMG IDL, of all three kinds."""

_ADAPTED: Final = b"// generated from rosidl_adapter/"
_IGNORE_MARKERS: Final = ("COLCON_IGNORE", "AMENT_IGNORE")
_BUILD_FOLDERS: Final = ("build", "install", "log")
_MAX_FILE_NAME: Final = 255  # bytes, on all systems; names of packages are ASCII


@dataclass(frozen=True, slots=True)
class InterfaceFile:
    """`package/folder/name`, with the extension that its kind has, or .idl.

    `folder` is where the file really is, or what its package's list makes of it.
    """

    path: Path
    folder: str

    @property
    def is_idl(self) -> bool:
        """Whether it is written in OMG IDL."""
        return self.path.suffix == IDL

    @property
    def kind(self) -> str:
        """`msg`, `srv` or `action`: the extension, or the folder of an .idl file."""
        if not self.is_idl:
            return self.path.suffix[1:]
        return self.folder if self.folder in FOLDERS else "msg"

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

    `root` is its folder; `xml` is its package.xml and `listed` its own list of interfaces, where it has one.
    A package that stands for single files has `partial` set: it can find its other files too.
    """

    name: str
    root: Path
    files: tuple[InterfaceFile, ...]
    partial: bool = False
    xml: PackageXml | None = field(default=None, compare=False, repr=False)
    nodes: tuple[NodeFile, ...] = ()
    listed: InterfaceList | None = field(default=None, compare=False, repr=False)

    @property
    def has_interfaces(self) -> bool:
        """Whether there are any, or would be if its list were right."""
        return bool(self.files) or (self.listed is not None and self.listed.is_wrong)

    @property
    def declared(self) -> Span | None:
        """Where package.xml names it."""
        return self.xml.span if self.xml else None

    @cached_property
    def _on_disk(self) -> Mapping[tuple[str, str], InterfaceFile]:
        known = {(file.folder, file.name): file for file in _files_of(self.root)[0]} if self.partial else {}
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


WithDeps = bool | Literal["own"]
"""Which dependencies to generate: none, all, or those that are found in the folders to include."""


class SearchPath:
    """Finds the packages that others depend on, by name and only when asked.

    In this order: the packages given, the folders to include, AMENT_PREFIX_PATH, the interpreter's own
    `share` folder (where the ros-* wheels put theirs) and its packages (where pip puts those that ifgen made
    installable), and the packages that come with ifgen. InterfaceError if one of the folders to include does
    not exist.
    """

    def __init__(self, given: Sequence[PackageFiles] = (), include: Sequence[Path | str] = ()) -> None:
        self._known: dict[str, PackageFiles | None] = {package.name: package for package in given}
        self._xmls: dict[str, PackageXml | None] = {}
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

    def comes_along(self, name: str, with_deps: WithDeps) -> bool:
        """Whether a dependency is to be generated too."""
        return name in self._included if with_deps == "own" else with_deps

    def is_own(self, name: str) -> bool:
        """Whether a package that was not asked for is in the folders to include."""
        package = self.find(name)
        return package is not None and package is self._included.get(name)

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

    def package_xml(self, name: str) -> PackageXml | None:
        """What the package.xml of a package says, be it one with interfaces or installed; None if unknown."""
        package = self.find(name)
        if package is not None and package.xml is not None:
            return package.xml
        if name not in self._xmls:
            roots = [package.root] if package else [share / name for share in self._shares]
            self._xmls[name] = next((xml for root in roots if (xml := package_xml.read(root, []))), None)
        return self._xmls[name]

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
                names.update(path.name for path in share.iterdir() if _installed_files(path))
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
            files, nodes = _installed_files(share / name), _nodes_below(share / name)
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
        return [*_installed_shares(), resources.bundled_interfaces()]


def _installed_shares() -> list[Path]:
    prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    shares = [Path(prefix) / "share" for prefix in (*prefixes, sys.prefix)]
    # pip puts what `ifgen generate` made installable among the packages of Python.
    return [*shares, Path(sysconfig.get_path("purelib"))]


def _packages_at(path: Path, problems: list[Diagnostic]) -> Iterator[PackageFiles]:
    folder = path.absolute()
    if not stat.S_ISDIR(path.stat().st_mode):
        yield from _package_of_files([path], problems)
    elif folder.name in FOLDERS and (paths := _interface_paths(folder)):
        yield from _package_of_files(paths, problems, folder)
    elif folder.name == NODE_FOLDER and (nodes := _nodes_below(folder.parent)):
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
        known = _files_of(root)[0] if root else ()
        if not any(place in file.path.absolute().parents for file in known):
            root = place.parent  # a package without package.xml, within another one perhaps
    root = root or place
    known, listed = _files_of(root)
    by_path = {os.path.realpath(file.path): file for file in known}
    nodes = tuple(NodeFile(path) for path in paths if node_name(path.name) is not None)
    files = [
        by_path.get(os.path.realpath(path))
        or InterfaceFile(path, place.name if in_place else _folder_of(path))
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
    return next((folder for folder in (place, *place.parents) if (folder / package_xml.NAME).is_file()), None)


def _packages_below(
    folder: Path, seen: set[tuple[int, int]], problems: list[Diagnostic]
) -> Iterator[PackageFiles]:
    """Look into a folder and, unless it is a package, into those that it holds; links lead nowhere twice."""
    try:
        status = folder.stat()
        names = {entry.name: entry.is_dir() for entry in os.scandir(folder)}
        is_ignored = bool(seen) and not names.keys().isdisjoint(_IGNORE_MARKERS)
        if is_ignored or (status.st_dev, status.st_ino) in seen:
            return
        seen.add((status.st_dev, status.st_ino))
        if manifest.NAME in names and is_generated(folder):
            return
        may_have_files = package_xml.NAME in names or not names.keys().isdisjoint(FOLDERS)
        files, listed = _files_of(folder) if may_have_files else ((), None)
        nodes = _nodes_below(folder) if NODE_FOLDER in names else ()
    except OSError as error:
        problems.append(unreadable(folder, error))
        return
    if files or nodes or (listed and listed.is_wrong):
        yield _package(folder, files, nodes, listed, problems)
        return
    for name in sorted(names):
        if names[name] and not name.startswith(".") and name not in _BUILD_FOLDERS:
            yield from _packages_below(folder / name, seen, problems)


def is_generated(folder: Path) -> bool:
    """Whether ifgen wrote a package there, from sources elsewhere."""
    try:
        record = manifest.read(folder)
    except (OSError, ValueError):
        return True
    if record is None or not record.interfaces:
        return False
    source = record.source_folder(folder.parent)
    return source is None or source.resolve() != folder.resolve()


def _files_of(root: Path) -> tuple[tuple[InterfaceFile, ...], InterfaceList | None]:
    """The interfaces of a package: those that it lists, else all that lie in its folders."""
    lies_there = _files_below(root)
    listed = interface_list.of_installed(root)
    if listed is None:
        paths = [file.path for file in lies_there]
        listed = interface_list.of_source(root, paths, _installed_shares())
    if listed is None:
        return lies_there, None
    in_folders = {} if listed.is_whole else {file.path: file for file in lies_there}
    return tuple(
        in_folders.get(path) or InterfaceFile(path, _folder_of(path)) for path in listed.paths
    ), listed


def _installed_files(root: Path) -> tuple[InterfaceFile, ...]:
    listed = interface_list.of_installed(root)
    if listed is None:
        return _files_below(root)
    return tuple(InterfaceFile(path, _folder_of(path)) for path in listed.paths)


def _folder_of(path: Path) -> str:
    """The folder that a listed file counts as if in, which its extension says."""
    return path.parent.name if path.suffix == IDL else path.suffix[1:]


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
    """The interface files in a folder, without what ROS installs beside them: parts, and .idl forms."""
    try:
        with os.scandir(folder) as entries:
            names = {entry.name for entry in entries if entry.name.endswith(EXTENSIONS)}
    except (FileNotFoundError, NotADirectoryError):
        return []
    return [
        folder / name
        for name in sorted(names)
        if not name.startswith(".")
        and not _is_part(name, folder, names)
        and not _is_form(name, folder, names)
    ]


def _is_part(name: str, folder: Path, names: Set[str]) -> bool:
    """Whether a file such as srv/SetBool_Request.msg was made from the service or action beside it."""
    whole, _, part = name.removesuffix(".msg").rpartition("_")
    wholes = {f"{whole}.{folder.name}", f"{whole}{IDL}"}
    return folder.name != "msg" and part in PARTS and not names.isdisjoint(wholes)


def _is_form(name: str, folder: Path, names: Set[str]) -> bool:
    """Whether a file such as msg/Pose.idl was made from the .msg file beside it."""
    stem = name.removesuffix(IDL)
    return stem != name and f"{stem}.{folder.name}" in names and is_adapted(folder / name)


def is_adapted(path: Path) -> bool:
    """Whether rosidl_adapter wrote an .idl file: then what it was made from counts, if that is there."""
    try:
        with path.open("rb") as file:
            return file.read(len(_ADAPTED)) == _ADAPTED
    except OSError:
        return False


def _package(
    root: Path,
    files: tuple[InterfaceFile, ...],
    nodes: tuple[NodeFile, ...],
    listed: InterfaceList | None,
    problems: list[Diagnostic],
    partial: bool = False,
) -> PackageFiles:
    """The package with the name that package.xml says, else that of its folder."""
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
    if path.is_dir() and (path / manifest.NAME).is_file() and is_generated(path):
        message = f"{path} is a package that ifgen generated, and no source of interfaces"
        return Diagnostic("no-interfaces", message, help="name the folder that it was generated from")
    if path.suffix in {".json", ".yaml", ".yml"}:
        message = f"{path} is no interface file"
        advice = f"if it describes a node, call it {path.stem}.nodl{path.suffix}"
        return Diagnostic("no-interfaces", message, help=advice)
    return Diagnostic(
        "no-interfaces",
        f"no interface files in {path}",
        help="a package keeps them in folders named msg, srv and action: PACKAGE/msg/Name.msg; and the "
        "descriptions of its nodes in PACKAGE/nodl/name.nodl.yaml",
    )

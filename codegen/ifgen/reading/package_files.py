"""The files of a package: its interfaces and its node descriptions."""

from __future__ import annotations

import os
import re
import sys
import sysconfig
from collections.abc import Mapping, Set
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final, NamedTuple

from ifgen.diagnostics import InputError, Source, Span
from ifgen.reading import interface_list, storage
from ifgen.reading.interface_list import FILE, INDEX, PARTS, InterfaceList
from ifgen.reading.listed_file import EXTENSIONS
from ifgen.reading.package_xml import PackageXml
from ifgen.reading.storage import read_limited, read_source, text_if_there

FOLDERS: Final = ("action", "msg", "srv")
"""The folders for interfaces. The extension of an interface file is the name of its folder, or idl."""

NODE_FOLDER: Final = "nodl"
"""The folder for node descriptions."""

NODE_EXTENSIONS: Final = (".nodl.json", ".nodl.yaml", ".nodl.yml")

IDL: Final = ".idl"
"""The extension of interfaces in OMG IDL, of all three kinds."""

_MODULE: Final = re.compile(rf"(?:^|[{{}};)])\s*module\s+({'|'.join(FOLDERS)})\b", re.MULTILINE)
_ADAPTED: Final = b"// generated from rosidl_adapter/"


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
        """The text of the file, with plain line ends; InputError if it cannot be read or is not UTF-8."""
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
        """The text of the file, with plain line ends; InputError if it cannot be read or is not UTF-8."""
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
    A package that stands for single files has `partial` set: it can find its other files too, except those
    `left_out`, by folder and name.
    """

    name: str
    root: Path
    files: tuple[InterfaceFile, ...]
    partial: bool = False
    xml: PackageXml | None = field(default=None, compare=False, repr=False)
    nodes: tuple[NodeFile, ...] = ()
    listed: InterfaceList | None = field(default=None, compare=False, repr=False)
    left_out: frozenset[tuple[str, str]] = frozenset()

    @property
    def has_interfaces(self) -> bool:
        """Whether there are any, or would be if its list were right."""
        return bool(self.files) or (self.listed is not None and self.listed.is_wrong)

    @property
    def declared(self) -> Span | None:
        """The place of the name in package.xml."""
        return self.xml.span if self.xml else None

    @cached_property
    def _on_disk(self) -> Mapping[tuple[str, str], InterfaceFile]:
        known = {(file.folder, file.name): file for file in contents(self.root).files} if self.partial else {}
        known.update(((file.folder, file.name), file) for file in self.files)
        return {key: file for key, file in known.items() if key not in self.left_out}

    def interface(self, folder: str, name: str) -> InterfaceFile | None:
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
            list(dict.fromkeys((*self.nodes, *nodes_below(self.root)))) if self.partial else list(self.nodes)
        )


def installed_shares() -> list[Path]:
    """The folders for shared files of ROS packages: AMENT_PREFIX_PATH, then the interpreter's own prefix."""
    prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    shares = [Path(prefix) / "share" for prefix in (*prefixes, sys.prefix)]
    # pip puts what `ifgen generate` made installable among the packages of Python.
    return [*shares, Path(sysconfig.get_path("purelib"))]


class Contents(NamedTuple):
    """The interfaces and nodes of a package, and its own list of interfaces, where it has one."""

    files: tuple[InterfaceFile, ...] = ()
    nodes: tuple[NodeFile, ...] = ()
    listed: InterfaceList | None = None


def contents(root: Path) -> Contents:
    """The contents of a package: the interfaces that it lists, else all that lie in its folders."""
    names = {folder: storage.names(root / folder) for folder in (*FOLDERS, NODE_FOLDER)}
    nodes = _nodes(root, names[NODE_FOLDER])
    lies_there = _interfaces(root, names)
    paths = [file.path for file in lies_there]
    index = text_if_there(root.parent / INDEX / root.name)
    cmake = root / FILE
    listed: InterfaceList | None = None
    try:
        source = read_source(cmake) if index is None and storage.is_file(cmake) else None
    except InputError as error:
        listed = InterfaceList(tuple(paths), error.diagnostics)
    else:
        if index is not None:
            listed = interface_list.of_installed(root, index)
        elif source is not None:
            listed = interface_list.of_source(root, source, paths, installed_shares())
    if listed is None:
        return Contents(lies_there, nodes)
    in_folders = {} if listed.is_whole else {file.path: file for file in lies_there}
    files = (in_folders.get(path) or InterfaceFile(path, folder_of(path)) for path in listed.paths)
    return Contents(tuple(files), nodes, listed)


def installed_files(root: Path) -> tuple[InterfaceFile, ...]:
    """The interfaces of an installed package: those of the ament index, else all files in its folders."""
    index = text_if_there(root.parent / INDEX / root.name)
    if index is None:
        return _files_below(root)
    listed = interface_list.of_installed(root, index)
    return tuple(InterfaceFile(path, folder_of(path)) for path in listed.paths)


def folder_of(path: Path) -> str:
    """The folder that a listed file counts as if in: its extension says it, or a module in an .idl file."""
    if path.suffix != IDL:
        return path.suffix[1:]
    if path.parent.name not in FOLDERS:
        with suppress(InputError):
            found = _MODULE.search(read_source(path).text)
            return found[1] if found else path.parent.name
    return path.parent.name


def _files_below(root: Path) -> tuple[InterfaceFile, ...]:
    return _interfaces(root, {folder: storage.names(root / folder) for folder in FOLDERS})


def _interfaces(root: Path, names: Mapping[str, Set[str]]) -> tuple[InterfaceFile, ...]:
    return tuple(
        InterfaceFile(path, folder)
        for folder in FOLDERS
        for path in _interface_paths(root / folder, names[folder])
    )


def nodes_below(root: Path) -> tuple[NodeFile, ...]:
    """The descriptions of nodes of a package."""
    return _nodes(root, storage.names(root / NODE_FOLDER))


def _nodes(root: Path, names: Set[str]) -> tuple[NodeFile, ...]:
    nodes = (name for name in sorted(names) if not name.startswith(".") and node_name(name) is not None)
    return tuple(NodeFile(root / NODE_FOLDER / name) for name in nodes)


def interface_paths(folder: Path) -> list[Path]:
    """The interface files in a folder, without what ROS installs beside them: parts, and .idl forms."""
    return _interface_paths(folder, storage.names(folder))


def _interface_paths(folder: Path, names: Set[str]) -> list[Path]:
    return [
        folder / name
        for name in sorted(names)
        if name.endswith(EXTENSIONS)
        and not name.startswith(".")
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
        return read_limited(path).startswith(_ADAPTED)
    except OSError:
        return False

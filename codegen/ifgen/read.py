"""Finds interface packages and their files: the only place that looks for input."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final

from ifgen import resources
from ifgen.diagnostics import Diagnostic, InterfaceError, Label, Source, Span

FOLDERS: Final = ("action", "msg", "srv")
"""Where a package keeps its interfaces; an interface file's extension is the name of its folder."""

_IGNORE_MARKERS: Final = ("COLCON_IGNORE", "AMENT_IGNORE")
_BUILD_FOLDERS: Final = ("build", "install", "log")


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
        """The text of the file; InterfaceError if it cannot be read or is not UTF-8.

        Windows line ends become plain ones, as Python's text mode has them.
        """
        try:
            data = self.path.read_bytes()
        except OSError as error:
            raise InterfaceError([_unreadable(self.path, error)]) from None
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError as error:
            raise InterfaceError([_not_utf8(self.path, data, error)]) from None
        return Source(self.path, text.replace("\r\n", "\n") if "\r" in text else text)


@dataclass(frozen=True)
class PackageFiles:
    """An interface package and the files of it that were asked for.

    `root` is its folder. A package that stands for single files has `partial` set: it can find its other files too.
    """

    name: str
    root: Path
    files: tuple[InterfaceFile, ...]
    partial: bool = False

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


def find_packages(paths: Iterable[Path | str]) -> tuple[PackageFiles, ...]:
    """Find the interface packages that paths stand for, sorted by name.

    A path is a package's folder, a folder that holds packages at any depth, or a single file, which stands for its
    package with just that file. InterfaceError if a path does not exist or leads to no interface.
    """
    found: dict[str, list[PackageFiles]] = {}
    problems: list[Diagnostic] = []
    for path in map(Path, paths):
        try:
            packages = list(_packages_at(path))
        except OSError as error:
            problems.append(_unreadable(path, error))
            continue
        if not packages:
            problems.append(_nothing_found(path))
        for package in packages:
            found.setdefault(package.name, []).append(package)
    if problems:
        raise InterfaceError(problems)
    return tuple(_merged(found[name]) for name in sorted(found))


@dataclass
class SearchPath:
    """Finds the packages that others depend on, by name and only when asked.

    In this order: the packages given, the folders to include, AMENT_PREFIX_PATH, the interpreter's own `share`
    folder (where the ros-* wheels put theirs), and the packages that come with ifgen.
    """

    given: Sequence[PackageFiles] = ()
    include: Sequence[Path | str] = ()
    _known: dict[str, PackageFiles | None] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        self._known.update((package.name, package) for package in self.given)

    def find(self, name: str) -> PackageFiles | None:
        """The package of this name; None if it is nowhere."""
        if name not in self._known:
            self._known[name] = self._look_for(name)
        return self._known[name]

    def places(self) -> list[str]:
        """Where it looks besides the given packages, in order."""
        return [*(str(path) for path in self.include), *map(str, self._shares())]

    def package_names(self) -> list[str]:
        """The names of all packages that can be found."""
        names = {package.name for package in (*self.given, *self._included.values())}
        for share in self._shares():
            if share.is_dir():
                names.update(entry.name for entry in os.scandir(share) if _is_package(Path(entry.path)))
        return sorted(names)

    def _look_for(self, name: str) -> PackageFiles | None:
        if name in self._included:
            return self._included[name]
        for share in self._shares():
            files = _files_below(share / name)
            if files:
                return PackageFiles(name, share / name, files)
        return None

    @cached_property
    def _included(self) -> Mapping[str, PackageFiles]:
        included: dict[str, PackageFiles] = {}
        for path in self.include:
            for package in find_packages([path]):
                included.setdefault(package.name, package)
        return included

    def _shares(self) -> list[Path]:
        prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
        shares = [Path(prefix) / "share" for prefix in (*prefixes, sys.prefix)]
        return [*shares, resources.bundled_interfaces()]


def _packages_at(path: Path) -> Iterator[PackageFiles]:
    if path.is_file():
        yield _package_of_files(path, [path])
    elif path.name in FOLDERS and (files := _interface_files(path)):
        yield _package_of_files(files[0], files)
    else:
        yield from _packages_below(path, seen=set())


def _package_of_files(first: Path, paths: Sequence[Path]) -> PackageFiles:
    first = first.absolute()
    root = first.parent.parent if first.parent.name in FOLDERS else first.parent
    files = tuple(InterfaceFile(path, first.parent.name) for path in paths)
    return PackageFiles(_package_name(root), root, files, partial=True)


def _packages_below(folder: Path, seen: set[tuple[int, int]]) -> Iterator[PackageFiles]:
    """Look into a folder and, unless it is a package itself, into those that it holds; links are followed once."""
    status = folder.stat()
    if (status.st_dev, status.st_ino) in seen:
        return
    seen.add((status.st_dev, status.st_ino))
    files = _files_below(folder)
    if files:
        yield PackageFiles(_package_name(folder), folder, files)
        return
    entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    if any(entry.name in _IGNORE_MARKERS for entry in entries):
        return
    for entry in entries:
        if entry.is_dir() and not entry.name.startswith(".") and entry.name not in _BUILD_FOLDERS:
            yield from _packages_below(Path(entry.path), seen)


def _is_package(folder: Path) -> bool:
    return any((folder / kind).is_dir() for kind in FOLDERS) and bool(_files_below(folder))


def _files_below(root: Path) -> tuple[InterfaceFile, ...]:
    return tuple(
        InterfaceFile(path, folder) for folder in FOLDERS for path in _interface_files(root / folder)
    )


def _interface_files(folder: Path) -> list[Path]:
    try:
        with os.scandir(folder) as entries:
            names = sorted(
                entry.name for entry in entries if entry.name.endswith((".msg", ".srv", ".action"))
            )
    except (FileNotFoundError, NotADirectoryError):
        return []
    return [folder / name for name in names if not name.startswith(".")]


def _package_name(root: Path) -> str:
    """What package.xml says, else the name of the folder."""
    manifest = root / "package.xml"
    if manifest.is_file():
        # Parsing XML is only worth its import where there is a package.xml.
        from xml.etree import ElementTree

        try:
            name = ElementTree.fromstring(manifest.read_bytes()).findtext("name")
        except (OSError, ElementTree.ParseError) as error:
            raise InterfaceError([_bad_manifest(manifest, f"package.xml cannot be read: {error}")]) from None
        if name is None or not name.strip():
            raise InterfaceError([_bad_manifest(manifest, "package.xml has no <name>")])
        return name.strip()
    return root.absolute().name


def _merged(packages: Sequence[PackageFiles]) -> PackageFiles:
    """One package of several finds of the same name, each file once."""
    if len(packages) == 1:
        return packages[0]
    files = {file.path.resolve(): file for package in packages for file in package.files}
    whole = next((package for package in packages if not package.partial), packages[0])
    return PackageFiles(whole.name, whole.root, tuple(files.values()), whole.partial)


def _unreadable(path: Path, error: OSError) -> Diagnostic:
    reason = error.strerror or str(error)
    return Diagnostic("unreadable-path", f"cannot read {path}: {reason}")


def _nothing_found(path: Path) -> Diagnostic:
    return Diagnostic(
        "no-interfaces",
        f"no interface files in {path}",
        help="a package keeps them in folders named msg, srv and action: PACKAGE/msg/Name.msg",
    )


def _bad_manifest(path: Path, message: str) -> Diagnostic:
    source = Source(path, path.read_bytes().decode("utf-8", "replace"))
    return Diagnostic("bad-package-xml", message, Label(Span(source, 0, 0)))


def _not_utf8(path: Path, data: bytes, error: UnicodeDecodeError) -> Diagnostic:
    start = len(data[: error.start].decode("utf-8").replace("\r\n", "\n"))
    source = Source(path, data.decode("utf-8", "replace").replace("\r\n", "\n"))
    return Diagnostic(
        "not-utf-8",
        f"the file is not UTF-8: byte 0x{data[error.start]:02x} at offset {error.start}",
        Label(Span(source, start, start + 1), "this byte"),
        help="save the file as UTF-8",
    )

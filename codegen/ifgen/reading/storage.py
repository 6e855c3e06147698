"""Folders and files to read from: those on disk, or those of a revision in the place of them.

All of `reading` looks at files through this module. So a revision of a repository is read by the same rules
as the folder, although nobody has checked it out.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import NamedTuple, Protocol


class Entry(NamedTuple):
    """A file or a folder within a folder."""

    name: str
    is_folder: bool
    is_link: bool = False


class Snapshot(Protocol):
    """The files of a folder at another time.

    Paths are relative to the folder, with `/`, and "" for the folder itself.
    """

    @property
    def name(self) -> str:
        """The name that users know it by."""
        ...

    @property
    def roots(self) -> tuple[str, ...]:
        """The absolute paths that the folder is known by."""
        ...

    def entries(self, path: str) -> list[Entry] | None:
        """The contents of a folder; None if there is no such folder."""
        ...

    def read(self, path: str) -> bytes | None:
        """The contents of a file; None if there is no such file."""
        ...

    def has_file(self, path: str) -> bool:
        """Whether there is such a file."""
        ...


_SNAPSHOTS: ContextVar[tuple[Snapshot, ...]] = ContextVar("_SNAPSHOTS", default=())


@contextmanager
def as_of(*snapshots: Snapshot) -> Generator[None]:
    """Read what is below the roots of the snapshots from these, until the context ends."""
    token = _SNAPSHOTS.set(snapshots)
    try:
        yield
    finally:
        _SNAPSHOTS.reset(token)


def revision(path: Path) -> str | None:
    """The name of the snapshot that a path is read from; None for the disk."""
    found = _within(path)
    return None if found is None else found[0].name


def is_file(path: Path) -> bool:
    """Whether there is a file. Raises OSError if the disk cannot say."""
    found = _within(path)
    return path.is_file() if found is None else found[0].has_file(found[1])


def is_folder(path: Path) -> bool:
    """Whether there is a folder. Raises OSError if the disk cannot say."""
    found = _within(path)
    return path.is_dir() if found is None else found[0].entries(found[1]) is not None


def leads_to_folder(path: Path) -> bool:
    """True for a folder, False for anything else that is there. Raises OSError if nothing is."""
    if _within(path) is None:
        return stat.S_ISDIR(path.stat().st_mode)
    if is_folder(path):
        return True
    if not is_file(path):
        raise _missing(path)
    return False


def exists(path: Path) -> bool:
    """Whether there is a file, a folder, or a link that leads nowhere."""
    return os.path.lexists(path) if _within(path) is None else is_file(path) or is_folder(path)


def entries(folder: Path) -> list[Entry]:
    """The contents of a folder. Raises OSError."""
    found = _within(folder)
    if found is None:
        with os.scandir(folder) as listed:
            return [Entry(entry.name, entry.is_dir(), entry.is_symlink()) for entry in listed]
    inside = found[0].entries(found[1])
    if inside is None:
        raise _missing(folder)
    return inside


def identity(folder: Path) -> object:
    """The same value for two paths to one folder. Raises OSError."""
    if _within(folder) is not None:
        return os.path.realpath(folder)
    status = folder.stat()
    return status.st_dev, status.st_ino


def read_snapshot(path: Path) -> bytes | None:
    """The contents of a file of a snapshot; None for one on disk. Raises OSError."""
    found = _within(path)
    if found is None:
        return None
    data = found[0].read(found[1])
    if data is None:
        raise _missing(path)
    return data


def _within(path: Path) -> tuple[Snapshot, str] | None:
    """The snapshot that has a path, and the path in it."""
    snapshots = _SNAPSHOTS.get()
    if not snapshots:
        return None
    absolute = os.path.abspath(path)  # noqa: PTH100 - without `..`, and without links followed
    for snapshot, root in _roots(snapshots):
        if absolute == root:
            return snapshot, ""
        if absolute.startswith(root + os.sep):
            return snapshot, absolute[len(root) + 1 :].replace(os.sep, "/")
    return None


def _roots(snapshots: tuple[Snapshot, ...]) -> Iterator[tuple[Snapshot, str]]:
    for snapshot in snapshots:
        for root in snapshot.roots:
            yield snapshot, root


def _missing(path: Path) -> OSError:
    return FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))

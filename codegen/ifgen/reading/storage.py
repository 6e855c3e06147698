"""Folders and files to read from: those on disk, or those of a revision in the place of them.

Everybody reads files through this module. So no pipe keeps ifgen waiting and no device fills its memory, and
a file that cannot be read is told of in one way. And a revision of a repository is read by the same rules as
the folder, although nobody has checked it out.
"""

from __future__ import annotations

import errno
import json
import os
import stat
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any, Final, NamedTuple, Protocol

from ifgen.diagnostics import Diagnostic, InputError, Label, Source, Span, near_names, shown_path

MAX_SIZE: Final = 4 * 2**20
"""Bytes of a file that somebody may have written: a hundred times what the largest interface has."""

MAX_GENERATED: Final = 2**28
"""Bytes of a file that ifgen may have written: ten times what its largest module has."""

_NEITHER_WAIT_NOR_PASS_ON: Final = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)


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


def names(folder: Path) -> frozenset[str]:
    """The names in a folder, none if there is no such folder. Raises OSError for one that cannot be read."""
    try:
        return frozenset(entry.name for entry in entries(folder))
    except (FileNotFoundError, NotADirectoryError):
        return frozenset()


def identity(folder: Path) -> object:
    """The same value for two paths to one folder. Raises OSError."""
    if _within(folder) is not None:
        return os.path.realpath(folder)
    status = folder.stat()
    return status.st_dev, status.st_ino


def read_source(path: Path) -> Source:
    """The text of a file, with plain line ends; InputError if it cannot be read or is not UTF-8."""
    data = read_bytes(path)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError([_not_utf8(path, data, error)]) from None
    return Source(path, text.replace("\r\n", "\n") if "\r" in text else text, revision(path))


def read_bytes(path: Path) -> bytes:
    """The text of a file. Raises InputError if it cannot be read, is not a file, or is too large."""
    try:
        return read_limited(path)
    except OSError as error:
        raise InputError([unreadable(path, error)]) from None


def text_if_there(path: Path) -> str | None:
    """The text of a file; None if it cannot be read or is not UTF-8."""
    try:
        return read_limited(path).decode("utf-8")
    except (OSError, ValueError):
        return None


def read_json(path: Path) -> Any:
    """The value in a file of JSON. Raises OSError as `read_limited` does, and ValueError if it is no JSON."""
    return json_of(read_limited(path, MAX_GENERATED))


def json_of(data: bytes) -> Any:
    """The value that is written as JSON. Raises ValueError if it is none."""
    try:
        return json.loads(data.decode("utf-8"))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def read_limited(path: Path, at_most: int = MAX_SIZE) -> bytes:
    """The bytes of a file. Raises OSError, also for a pipe, a device, and more than `at_most` bytes.

    Those would keep it waiting, or fill all memory.
    """
    data = _read_snapshot(path)
    if data is None:
        descriptor = os.open(path, os.O_RDONLY | _NEITHER_WAIT_NOR_PASS_ON | getattr(os, "O_BINARY", 0))
        try:
            status = os.fstat(descriptor)
            if stat.S_ISDIR(status.st_mode):
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
            if not stat.S_ISREG(status.st_mode):
                raise OSError(errno.EINVAL, "it is not a file, but a pipe, a device or a socket", str(path))
            data = os.read(descriptor, min(status.st_size, at_most) + 1)
            # Files of the kernel have more in them than they say, and networks may send less at once.
            while 0 < len(data) <= at_most and (part := os.read(descriptor, 2**20)):
                data += part
        finally:
            os.close(descriptor)
    if len(data) > at_most:
        raise OSError(errno.EFBIG, f"it is larger than {at_most // 2**20} MiB", str(path))
    return data


def unreadable(path: Path, error: OSError) -> Diagnostic:
    """Say that a file or a folder cannot be read."""
    return Diagnostic("unreadable-path", f"cannot read {shown_path(path)}: {error.strerror or error}")


def _not_utf8(path: Path, data: bytes, error: UnicodeDecodeError) -> Diagnostic:
    start = len(data[: error.start].decode("utf-8").replace("\r\n", "\n"))
    source = Source(path, data.decode("utf-8", "replace").replace("\r\n", "\n"), revision(path))
    return Diagnostic(
        "not-utf-8",
        f"the file is not UTF-8: byte 0x{data[error.start]:02x} at offset {error.start}",
        Label(Span(source, start, start + 1), "this byte"),
        help="save the file as UTF-8",
    )


def _read_snapshot(path: Path) -> bytes | None:
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


def near_paths(path: str | Path) -> list[str]:
    """The paths in the folder of one that does not exist which look most like it."""
    missing = Path(path)
    try:
        names = [] if os.path.lexists(missing) else [entry.name for entry in missing.parent.iterdir()]
    except (OSError, ValueError):
        return []
    return [str(missing.with_name(name)) for name in near_names(missing.name, names, limit=3)]


def _missing(path: Path) -> OSError:
    return FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))

"""Changes many files of a folder together, or none of them, one run at a time.

The system takes back the lock on a folder however its holder ends.
"""

from __future__ import annotations

import errno
import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias

from ifgen import resources

_POLL = 0.05
"""Seconds between two looks at a lock that Windows cannot wait for."""


@contextmanager
def exclusive(folder: Path) -> Generator[bool]:
    """Wait until no other run has a folder that exists; whether no other one has it for certain.

    Where folders cannot be locked (Windows, some network drives), a file in the user's cache stands for the
    folder: runs of other users and on other machines do not see that one.
    """
    with _folder_locked(folder) as locked:
        if locked:
            yield True
        else:
            with _file_locked(folder):
                yield False


def is_free(folder: Path) -> bool:
    """True if it is certain that no run is at work on a folder."""
    with suppress(ImportError, OSError):
        import fcntl  # not on Windows

        descriptor = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
            return True
        finally:
            os.close(descriptor)
    return False


@contextmanager
def _folder_locked(folder: Path) -> Generator[bool]:
    try:
        import fcntl  # not on Windows
    except ImportError:
        yield False
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        locked = False
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            locked = True
        yield locked
    finally:
        os.close(descriptor)


@contextmanager
def _file_locked(folder: Path) -> Generator[None]:
    """The same by a file; without any lock where there is no place for it."""
    name = hashlib.sha256(os.path.normcase(folder.resolve()).encode(errors="surrogateescape")).hexdigest()
    with ExitStack() as held:
        with suppress(OSError):
            path = resources.cache_folder() / "locks" / name[:32]
            path.parent.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
            held.callback(os.close, descriptor)
            held.callback(_lock_file(descriptor))
        yield


def _lock_file(descriptor: int) -> Callable[[], object]:
    """Wait for a lock on a file; what unlocks it. Raises OSError where it cannot be had."""
    try:
        import fcntl  # not on Windows
    except ImportError:
        return _lock_on_windows(descriptor)
    fcntl.flock(descriptor, fcntl.LOCK_EX)
    return partial(fcntl.flock, descriptor, fcntl.LOCK_UN)


def _lock_on_windows(descriptor: int) -> Callable[[], object]:
    try:
        msvcrt: Any = import_module("msvcrt")  # which checkers know on Windows only
    except ImportError as error:
        raise OSError("this system has no locks") from error
    while True:
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except PermissionError:  # another run has it; LK_LOCK would give up after ten seconds
            time.sleep(_POLL)
        else:
            return partial(msvcrt.locking, descriptor, msvcrt.LK_UNLCK, 1)


Change: TypeAlias = tuple[Path, bytes | None]
"""A file and its new content; None removes it."""

_STAGE = ".ifgen-tmp-"
_ATTEMPTS = 100
_FORGOTTEN = 3600.0
"""The age in seconds of a leftover stage, if it is unknown whether a run is at work."""


def apply(changes: Iterable[Change], directory: Path) -> None:
    """Make the changes, in order, to files below `directory`, as a `Stage` does."""
    with staging(directory) as stage:
        stage.apply([(path, None if data is None else stage.put(data)) for path, data in changes])


class Stage:
    """New contents of files of a folder, on the disk beside them until they replace them all together."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._folder: Path | None = None
        self._count = 0

    def put(self, data: bytes) -> Path:
        """Keep a new content. Raises OSError (disk full, no permission)."""
        self._count += 1
        place = self._made() / f"new{self._count}"
        try:
            place.write_bytes(data)
        except OSError as error:  # a full disk has no name by itself
            error.filename = error.filename or str(self._directory)
            raise
        return place

    def apply(self, changes: Sequence[tuple[Path, Path | None]]) -> None:
        """Replace files, in order, by contents that were put here, as `apply_all` does."""
        apply_all([(self, changes)])

    def apply_until(
        self, changes: Sequence[tuple[Path, Path | None]], undo: list[Callable[[], object]]
    ) -> None:
        """Make the changes up to one that fails; `undo` grows by the steps that take them back."""
        for i, (path, new) in enumerate(changes):
            _make_folder(path.parent, undo)
            _remember(path, self._made() / f"old{i}", undo)
            if new is None:
                path.unlink()
            else:
                new.replace(path)

    def clear(self) -> None:
        """Remove what is left."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _made(self) -> Path:
        if self._folder is None:
            _clear(left_over(self._directory, alone=False))
            made = tempfile.mkdtemp(prefix=_STAGE, dir=self._directory)
            self._folder = self._directory / Path(made).name  # relative if that is
        return self._folder


def apply_all(stages: Iterable[tuple[Stage, Sequence[tuple[Path, Path | None]]]]) -> None:
    """Replace files of several folders, in order, by contents that were put there; None removes a file.

    Each file changes in one step: a reader sees the old or the new one. Raises OSError; then, as after
    Ctrl-C, every file is as before.
    """
    with _undone_on_failure() as undo:
        for stage, changes in stages:
            stage.apply_until(changes, undo)


@contextmanager
def staging(directory: Path) -> Generator[Stage]:
    """A stage in a folder, which is gone after the block."""
    stage = Stage(directory)
    try:
        yield stage
    finally:
        stage.clear()


@contextmanager
def locked(directory: Path) -> Generator[None]:
    """Let one run at a time work on an output folder, which is made if need be, and unmade if nothing came.

    Remove the leftovers of killed runs.
    """
    with ExitStack() as held:
        alone = _locked_at_last(directory, held)
        _clear(left_over(directory, alone=alone))
        yield


@contextmanager
def all_locked(directories: Iterable[Path]) -> Generator[None]:
    """The same for several folders, each once, in an order in which no two runs wait for each other."""
    folders = {os.path.normcase(folder.resolve()): folder for folder in directories}
    with ExitStack() as held:
        for _, folder in sorted(folders.items()):
            held.enter_context(locked(folder))
        yield


def _locked_at_last(directory: Path, held: ExitStack) -> bool:
    """Make and lock a folder; again if another run, which made it too, removes it because nothing came."""
    for _ in range(_ATTEMPTS):
        with ExitStack() as attempt, suppress(FileNotFoundError):
            alone = _entered(directory, attempt)
            held.push(attempt.pop_all())
            return alone
    return _entered(directory, held)


def _entered(directory: Path, held: ExitStack) -> bool:
    """Make a folder if need be, and lock it. Raises FileNotFoundError if it is gone once it is locked."""
    made = [folder for folder in (directory, *directory.parents) if not folder.exists()]
    directory.mkdir(parents=True, exist_ok=True)
    before = directory.stat()
    alone = held.enter_context(exclusive(directory))
    held.callback(_remove_empty, made)  # while it is locked, so that nobody has begun to work in it
    if not os.path.samestat(before, directory.stat()):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(directory))
    return alone


def _remove_empty(folders: Sequence[Path]) -> None:
    with suppress(OSError):
        for folder in folders:
            folder.rmdir()


def left_over(directory: Path, *, alone: bool) -> list[Path]:
    """The leftovers of killed runs in a folder; `alone` if certainly no other run is at work there."""
    now = time.time()
    found: list[Path] = []
    for stage in sorted(directory.glob(_STAGE + "*")):
        with suppress(OSError):  # the run that it belongs to has just ended
            if alone or now - stage.stat().st_mtime > _FORGOTTEN:
                found.append(stage)
    return found


def _clear(stages: Iterable[Path]) -> None:
    for stage in stages:
        shutil.rmtree(stage, ignore_errors=True)


@contextmanager
def _undone_on_failure() -> Generator[list[Callable[[], object]]]:
    undo: list[Callable[[], object]] = []
    try:
        yield undo
    except BaseException:  # Ctrl-C too
        for step in reversed(undo):
            with suppress(OSError):
                step()
        raise


def _make_folder(folder: Path, undo: list[Callable[[], object]]) -> None:
    if not folder.exists():
        _make_folder(folder.parent, undo)
        folder.mkdir()
        undo.append(folder.rmdir)


def _remember(path: Path, backup: Path, undo: list[Callable[[], object]]) -> None:
    """Keep what is there now, time stamp included, so that it can be put back."""
    if not path.exists():
        undo.append(partial(path.unlink, missing_ok=True))
        return
    try:
        os.link(path, backup)
    except OSError:  # a file system without hard links
        shutil.copy2(path, backup)
    undo.append(partial(backup.replace, path))

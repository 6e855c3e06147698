"""One run at a time on a folder, by a lock that the system takes back however its holder ends."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

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

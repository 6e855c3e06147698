"""Where a bag is written: never over what exists, and all of it or nothing."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from ifgen.command_kit.tool import ToolError


def require_new(path: Path) -> None:
    """Raise ToolError if something is there already."""
    if os.path.lexists(path):
        raise ToolError(f"{path} exists already", help="name another place with -o, or delete it first")


@contextmanager
def whole(path: Path) -> Generator[Path]:
    """A place to write to, which becomes `path` at the end of the block.

    Whatever goes wrong, nothing is left. Raises ToolError if the file system refuses.
    """
    require_new(path)
    place = path.with_name(f".{path.name}.{os.getpid()}{path.suffix}")
    with telling(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield place
            place.rename(path)
        except BaseException:
            if place.is_dir():
                shutil.rmtree(place, ignore_errors=True)
            else:
                for file in path.parent.glob(f"{place.name}*"):  # a database has others beside it
                    file.unlink(missing_ok=True)
            raise


@contextmanager
def telling(path: Path) -> Generator[None]:
    """Raise ToolError for what the file system refuses while something is written to `path`."""
    # Late: what writes has loaded them anyway.
    import sqlite3

    from ifgen_runtime.bag.errors import BagError

    try:
        yield
    except BagError as error:
        cause = error.__cause__
        is_full = isinstance(cause, OSError) and cause.errno in _FULL
        raise ToolError(str(error), help=_FREE if is_full else "") from None
    except OSError as error:
        if error.errno in _FULL:
            raise ToolError(f"{path} cannot be written: the disk is full", help=_FREE) from None
        raise ToolError(f"{path} cannot be written: {error.strerror or error}") from None
    except sqlite3.Error as error:
        is_full = getattr(error, "sqlite_errorname", "") == "SQLITE_FULL"
        reason = "the disk is full" if is_full else str(error)
        raise ToolError(f"{path} cannot be written: {reason}", help=_FREE if is_full else "") from None


_FULL: Final = frozenset({errno.ENOSPC, errno.EDQUOT})
_FREE: Final = "make room, or name a place on another disk with -o"

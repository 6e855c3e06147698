"""Bags on the disk as commands open and write them, and what they say about them.

A bag may have put anything into a text: nothing in it steers a terminal.
"""

from __future__ import annotations

import errno
import os
import shutil
import sys
import warnings
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ifgen.command_kit.tool import ToolError
from ifgen.diagnostics import printable

if TYPE_CHECKING:
    from ifgen_runtime.bag import Bag

# Late imports: most verbs of the command line read no bag.


def show(text: str) -> None:
    """Print what the user asked for."""
    print(printable(text))


def say(text: str) -> None:
    """Tell the user, beside what others may read from the output."""
    print(printable(text), file=sys.stderr, flush=True)


def warn(text: str) -> None:
    """Warn the user."""
    say(f"warning: {text}")


def inline(text: str) -> str:
    """A text without ends of lines."""
    return printable(text).replace("\n", "\N{SYMBOL FOR LINE FEED}")


@contextmanager
def reading(path: Path, *, unlimited: bool = False) -> Generator[Bag]:
    """An open bag. Raises ToolError for what is wrong with it; damage that it can skip is a warning."""
    from ifgen_runtime.bag import Bag, BagError, BagWarning

    def tell(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
        if issubclass(category, BagWarning):
            warn(str(message))
        else:
            usual(message, category, *_, **__)

    with warnings.catch_warnings():
        warnings.simplefilter("always", BagWarning)
        usual, warnings.showwarning = warnings.showwarning, tell
        try:
            with Bag(path, unlimited=unlimited) as bag:
                yield bag
        except BagError as error:
            raise ToolError(str(error), help=_help(path, str(error))) from None


def _help(path: Path, error: str) -> str:
    from ifgen_runtime.bag.errors import UNPACKS

    if UNPACKS in error:
        return "if you trust it, read all of it with --unlimited"
    if not path.exists():
        return "name a .mcap or .db3 file, or a folder that `bag record` made"
    return ""


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
    with disk_errors(path):
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
def disk_errors(path: Path) -> Generator[None]:
    """Raise ToolError for what the file system refuses while something is written to `path`."""
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

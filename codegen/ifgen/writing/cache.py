"""Data kept between runs, in the user's cache folder. Any failure there costs only time."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from ifgen import resources
from ifgen.writing import transaction


def folder(name: str = ".") -> Path:
    """A folder in the user's cache folder, made if it is not there. Raises OSError if it cannot be."""
    made = resources.cache_folder() / name
    made.mkdir(parents=True, exist_ok=True)
    return made


def keep(path: Path, text: str) -> None:
    """Write a file in the user's cache folder, all of it or, where that cannot be, none."""
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        transaction.apply([(path, text.encode())], path.parent)

"""`file(GLOB)` and `get_filename_component()`: what CMake asks of the file system and of paths."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import Final

from ifgen.reading import storage
from ifgen.reading.cmake.patterns import Unsure, glob
from ifgen.reading.cmake.values import joined

_MAGIC: Final = frozenset("*?[")


def file_command(
    words: Sequence[str], folder: Path, spend: Callable[[int], None]
) -> Iterator[tuple[str, str]]:
    """The variables that `file(WORDS)` sets; `spend` gets the number of entries looked at. Raises Unsure."""
    match list(words):
        case [("GLOB" | "GLOB_RECURSE") as how, out, *rest]:
            yield out, joined(_globbed(how == "GLOB_RECURSE", rest, folder, spend))
        case ["RELATIVE_PATH", out, start, path]:
            yield out, os.path.relpath(path, start).replace(os.sep, "/")
        case [("TO_CMAKE_PATH" | "TO_NATIVE_PATH"), path, out]:
            yield out, path
        case [("MAKE_DIRECTORY" | "COPY" | "WRITE" | "INSTALL" | "REMOVE"), *_]:
            return
        case _:
            raise Unsure


def filename_component(words: Sequence[str], folder: Path) -> Iterator[tuple[str, str]]:
    """The variables that `get_filename_component(WORDS)` sets. Raises Unsure."""
    match list(words):
        case [out, path, mode, *rest] if set(rest) <= {"CACHE"} or (len(rest) == 2 and rest[0] == "BASE_DIR"):
            base = Path(rest[1]) if len(rest) == 2 else folder
            yield out, _component(path.rstrip("/") or path, mode, base)
        case _:
            raise Unsure


def _component(path: str, mode: str, base: Path) -> str:
    folder, slash, name = path.rpartition("/")
    match mode:
        case "DIRECTORY" | "PATH":
            return folder or (slash if path.startswith("/") else "")
        case "NAME":
            return name
        case "EXT":
            return _extension(name, name.find("."))
        case "LAST_EXT":
            return _extension(name, name.rfind("."))
        case "NAME_WE":
            return name.removesuffix(_extension(name, name.find(".")))
        case "NAME_WLE":
            return name.removesuffix(_extension(name, name.rfind(".")))
        case "ABSOLUTE" | "REALPATH":
            return Path(os.path.normpath(base / path)).as_posix()
        case _:
            raise Unsure


def _extension(name: str, at: int) -> str:
    return name[at:] if at >= 0 else ""


def _globbed(
    recurse: bool, words: Sequence[str], folder: Path, spend: Callable[[int], None]
) -> Iterator[str]:
    """The paths that match, sorted for each pattern."""
    relative: str | None = None
    with_folders = not recurse
    at = 0
    while at < len(words):
        match words[at]:
            case "RELATIVE" if at + 1 < len(words):
                relative = words[at + 1]
                at += 1
            case "LIST_DIRECTORIES" if at + 1 < len(words):
                with_folders = words[at + 1].upper() in {"1", "ON", "TRUE", "YES"}
                at += 1
            case "CONFIGURE_DEPENDS" | "FOLLOW_SYMLINKS":
                pass
            case pattern:
                for path in sorted(_matches(pattern, recurse, with_folders, folder, spend)):
                    text = path if relative is None else os.path.relpath(path, folder / relative)
                    yield text.replace(os.sep, "/")
        at += 1


def _matches(
    pattern: str, recurse: bool, with_folders: bool, folder: Path, spend: Callable[[int], None]
) -> Iterator[str]:
    whole = PurePosixPath(os.path.normpath((folder / pattern).as_posix()))
    fixed = len(whole.parts) - 1
    for number, part in enumerate(whole.parts):
        if not _MAGIC.isdisjoint(part):
            fixed = min(fixed, number)
            break
    pending = [(Path(*whole.parts[:fixed]), whole.parts[fixed:])]
    while pending:
        place, (part, *rest) = pending.pop()
        matcher = glob(part)
        for name, is_folder, is_link in _entries(place, spend):
            path = place / name
            if matcher.fullmatch(name):
                if rest and is_folder:
                    pending.append((path, tuple(rest)))
                elif not rest and (with_folders or not is_folder):
                    yield path.as_posix()
            if recurse and not rest and is_folder and not is_link:
                pending.append((path, (part,)))


def _entries(place: Path, spend: Callable[[int], None]) -> Iterator[storage.Entry]:
    """The entries of a folder; none if it cannot be read."""
    try:
        for entry in storage.entries(place):
            spend(100)
            yield entry
    except (OSError, ValueError):
        return

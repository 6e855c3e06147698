"""The user's generated packages with names that a real ROS has: which replace those, and which must not.

The compiled packages of a ROS read and write the fields that they were compiled with. So a package that
others of them use can only be replaced by its equal.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

from ifgen import resources
from ifgen.reading import manifest

_KINDS: Final = ("msg", "srv", "action")
_HASH: Final = re.compile(r'__type_hash__ = "(RIHS01_[0-9a-f]{64})"')


class OverlayError(Exception):
    """The user's package must not replace the one of ROS; the text says why and what to do."""


def path_on_ros(
    real: Sequence[str], ros: Sequence[str], own: Sequence[str], beside: Iterable[str]
) -> list[str]:
    """The path for a real ROS, and before it the user's folders with packages that replace some of ROS.

    `real` is the path without our folders, `ros` are those entries that have packages of ROS, `own` are the
    folders of the output, and `beside` those of programs. Raises OverlayError.
    """
    first = next((index for index, entry in enumerate(real) if entry in ros), len(real))
    before = [*beside, *real[:first]]
    for folder in before:
        for name, theirs in _namesakes(folder, ros):
            _refuse_if_used(name, Path(folder), theirs, ros)
    users = [[entry] for entry in real[first:] if entry not in ros]
    moved: list[str] = []
    for folders in [*users, [*own]] if own else users:
        if _replaces(folders[0], ros, [*before, *moved]):
            moved += folders
    return [*real[:first], *moved, *(entry for entry in [*real[first:], *own] if entry not in moved)]


def _replaces(folder: str, ros: Sequence[str], before: Sequence[str]) -> bool:
    """Whether a folder has to go before a ROS, and after others. Raises OverlayError if it must not."""
    mine = Path(folder)
    namesakes = [
        (name, theirs)
        for name, theirs in _namesakes(folder, ros)
        if not any((Path(other) / name / "__init__.py").is_file() for other in before)
    ]
    replaced = [name for name, theirs in namesakes if _differs(mine / name, theirs)]
    for name, theirs in namesakes if replaced else ():
        _refuse_if_used(name, mine, theirs, ros)
        if name not in replaced and _user(name, ros):
            raise OverlayError(
                f"{folder} has packages that replace those of ROS ({', '.join(replaced)}), and a copy of "
                f"'{name}' in {theirs}, which ROS itself uses: generate without --with-deps, or use "
                "--transport local"
            )
    return bool(replaced)


def _refuse_if_used(name: str, folder: Path, theirs: Path, ros: Sequence[str]) -> None:
    if (user := _user(name, ros)) and _differs(folder / name, theirs):
        raise OverlayError(
            f"'{name}' in {folder} has other definitions than the one of ROS in {theirs}, which '{user}' was "
            "compiled with: give your package another name, or use --transport local"
        )


def _namesakes(folder: str, ros: Sequence[str]) -> Iterator[tuple[str, Path]]:
    """The generated packages of messages in a folder that ROS has as well, with the folder of the latter."""
    with suppress(OSError):
        for package in sorted(Path(folder).iterdir()):
            if not (package / manifest.NAME).is_file() or not _has_interfaces(package):
                continue
            for theirs in (Path(entry) / package.name for entry in ros):
                if (theirs / "__init__.py").is_file() and _has_interfaces(theirs):
                    yield package.name, theirs
                    break


def _has_interfaces(package: Path) -> bool:
    return any((package / kind / "__init__.py").is_file() for kind in _KINDS)


def _differs(mine: Path, theirs: Path) -> bool:
    """Whether a package has a type that the one of ROS has not, or has otherwise.

    A copy of a package that comes with ifgen does not count: it stands in where there is no ROS.
    """
    ours = set(_hashes(resources.bundled_generated() / mine.name))
    return any(
        _hash_in_ros(theirs, kind, name) != known
        for kind, name, known in _hashes(mine)
        if (kind, name, known) not in ours
    )


def _hashes(package: Path) -> Iterator[tuple[str, str, str]]:
    """The types of a generated package with their hashes, as the text of its modules says."""
    for kind in _KINDS:
        for file in (package / kind).glob("_*.py"):
            for part in file.read_text(encoding="utf-8").split("\nclass ")[1:]:
                name = re.match(r"[A-Z]\w*", part)
                found = _HASH.search(part)
                if name and found and "_" not in name[0]:  # the parts of services and actions follow these
                    yield kind, name[0], found[1]


def _hash_in_ros(package: Path, kind: str, name: str) -> str | None:
    """The hash of a type as the shared files of a ROS say; None if they do not."""
    for prefix in package.parents[3:6]:  # above lib/python3.x/site-packages, or local/lib/...
        file = prefix / "share" / package.name / kind / f"{name}.json"
        with suppress(OSError, ValueError, KeyError, TypeError):
            for each in json.loads(file.read_bytes())["type_hashes"]:
                if each["type_name"] == f"{package.name}/{kind}/{name}":
                    return str(each["hash_string"])
    return None


def _user(name: str, ros: Sequence[str]) -> str:
    """The name of a package of ROS that imports this one; empty if none does."""
    importing = re.compile(rf"^\s*(from|import) {name}\b", re.MULTILINE)
    for entry in ros:
        for package in sorted(Path(entry).iterdir()):
            if package.name == name or not (package.name == "rclpy" or _has_interfaces(package)):
                continue
            for file in package.rglob("*.py"):
                with suppress(OSError):
                    if importing.search(file.read_text(encoding="utf-8", errors="replace")):
                        return package.name
    return ""

"""Where packages are if no ROS says so: all this counts only where AMENT_PREFIX_PATH is not set.

Upstream raises there, so a program that works with ROS is not affected.
"""

import os
import sys
from collections.abc import Iterator
from importlib.machinery import PathFinder
from pathlib import Path

from ament_index_python.constants import AMENT_PREFIX_PATH_ENV_VAR, RESOURCE_INDEX_SUBFOLDER


def prefixes() -> list[str]:
    """The prefix of Python, if pip has installed a package of ROS there, with its index and shared files."""
    return [sys.prefix] if Path(sys.prefix, RESOURCE_INDEX_SUBFOLDER).is_dir() else []


def source_folder(package_name: str) -> str | None:
    """The folder with the package.xml of a package whose sources are on `sys.path`, or beside such a one.

    A program in `src/my_pkg/my_pkg/node.py` has `src/my_pkg/my_pkg` there. So the two folders around an entry
    count as well, and what is beside `my_pkg`.
    """
    if os.environ.get(AMENT_PREFIX_PATH_ENV_VAR):
        return None
    for folder in _folders(package_name):
        for candidate in (folder, folder / package_name):
            if _name_in(candidate / "package.xml") == package_name:
                return str(candidate)
    return None


def _folders(package_name: str) -> Iterator[Path]:
    spec = PathFinder.find_spec(package_name)
    entries = [*((spec and spec.submodule_search_locations) or ()), *sys.path]
    for entry in dict.fromkeys(entries):
        path = Path(entry or os.curdir).absolute()
        yield from (path, *list(path.parents)[:2])


def _name_in(manifest: Path) -> str | None:
    if not manifest.is_file():
        return None
    from xml.etree import ElementTree  # slow to import, and seldom needed

    try:
        return (ElementTree.parse(manifest).findtext("name") or "").strip()
    except (OSError, ElementTree.ParseError):
        return None

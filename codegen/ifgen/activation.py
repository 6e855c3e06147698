"""Chooses where `rclpy` and the message packages come from: our local transport, or the real ROS 2.

Folders of top-level packages go on `sys.path`, and nothing else happens: no import hooks, no aliases.
All or nothing: a real `std_msgs` under our `rclpy`, or our `rcl_interfaces` under the real one, would fail in
ways that are hard to understand, so a mixture is refused.
"""

from __future__ import annotations

import importlib.machinery
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Literal

from ifgen import manifest, resources

Transport = Literal["local", "rclpy"]


class ActivationError(RuntimeError):
    """This process cannot use that transport; the text says why and what to do."""


def activate(
    transport: Literal["local", "rclpy", "auto"] = "auto", generated: Path | None = None
) -> Transport:
    """Let `import rclpy` and `import std_msgs.msg` find one transport's packages, and say which one.

    `local`: our rclpy and our message packages, even where a real ROS is installed. `rclpy`: the real ones;
    our packages only fill the gaps. `auto`: the real ones where they are installed, else `local`.
    `generated` is a folder of yours with generated packages; those of messages and nodes are found as well.
    Call it before the first import of either. Raises ActivationError if that is too late, or if there is no
    real rclpy to use.
    """
    if transport not in {"local", "rclpy", "auto"}:
        raise ValueError(f"transport must be 'local', 'rclpy' or 'auto', got {transport!r}")
    real = _real_path()
    chosen = transport
    if chosen == "auto":
        imported = sys.modules.get("rclpy")
        prefer_real = _finds("rclpy", real) if imported is None else not _is_ours(imported)
        chosen = "rclpy" if prefer_real else "local"
    if chosen == "rclpy" and not _finds("rclpy", real):
        raise ActivationError(
            "there is no real rclpy to import: source /opt/ros/jazzy/setup.sh, "
            "or run `pip install 'ifgen[ros]'` (Linux x86_64)"
        )
    _refuse_mixture(chosen, real)
    underlay, bundled = str(resources.underlay()), str(resources.bundled_generated())
    # A package of yours wins over one of that name that comes with ifgen, but never over a real one.
    ours = [*(import_folders(generated) if generated else ()), bundled, *_bundled_nodes()]
    path = [underlay, *ours, *real] if chosen == "local" else [*real, *ours]
    sys.path[:] = list(dict.fromkeys(path))
    return chosen


def folder_around(path: Path) -> Path | None:
    """The folder of generated packages that a file is in, whatever it is called; None if it is in none."""
    for package in path.resolve().parents:
        if (package / manifest.NAME).is_file():
            return package.parent
    return None


def import_folders(generated: Path) -> list[str]:
    """What has to be on `sys.path` for the packages in a folder: the folder, and each package with nodes."""
    if not generated.is_dir():
        return []
    folders = (entry for entry in sorted(generated.resolve().iterdir()) if is_node_package(entry))
    return [str(generated.resolve()), *map(str, folders)]


def is_node_package(folder: Path) -> bool:
    """Whether a generated package is laid out as nodes are: what Python imports is inside its folder."""
    return (folder / folder.name / "__init__.py").is_file() and (folder / manifest.NAME).is_file()


@cache
def _bundled_nodes() -> list[str]:
    return import_folders(resources.bundled_generated())[1:]


def _real_path() -> list[str]:
    """`sys.path` without our folders."""
    ours = {str(resources.underlay()), str(resources.bundled_generated()), *_bundled_nodes()}
    return [entry for entry in sys.path if entry not in ours]


def _finds(name: str, path: list[str]) -> bool:
    """Whether a package can be imported from a path; nothing is imported: the real rclpy takes long."""
    return importlib.machinery.PathFinder.find_spec(name, path) is not None


def _refuse_mixture(chosen: Transport, real: list[str]) -> None:
    for name in _names():
        module = sys.modules.get(name)
        if module is None or _is_ours(module) == (chosen == "local"):
            continue
        if chosen == "rclpy" and not _finds(name, real):
            continue  # ours fills a gap
        found, wanted = ("ROS", "local transport") if chosen == "local" else ("local transport", "real rclpy")
        raise ActivationError(
            f"'{name}' is already imported from {_home(module)} ({found}), which does not go with the "
            f"{wanted}: call ifgen.activate({chosen!r}) before the first import of rclpy or a message package"
        )


def _names() -> Iterator[str]:
    """The top-level packages that both transports have."""
    for folder in (resources.underlay(), resources.bundled_generated()):
        if folder.is_dir():
            yield from sorted(e.name for e in folder.iterdir() if (e / "__init__.py").is_file())


def _is_ours(module: ModuleType) -> bool:
    home = _home(module)
    return home is not None and (home.parent == resources.underlay() or (home / manifest.NAME).exists())


def _home(module: ModuleType) -> Path | None:
    """The folder of an imported package."""
    return Path(next(iter(module.__path__))) if hasattr(module, "__path__") else None

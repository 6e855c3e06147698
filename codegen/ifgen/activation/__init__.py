"""Chooses where `rclpy` and the message packages come from: our local transport, or the real ROS 2.

Folders of top-level packages go on `sys.path`, and nothing else happens: no import hooks, no aliases.
All or nothing: a real `std_msgs` under our `rclpy`, or our `rcl_interfaces` under the real one, would fail in
ways that are hard to understand, so a mixture is refused. This room only finds files; it imports no rclpy.
"""

from __future__ import annotations

import importlib.machinery
import os
import re
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, Final, Literal

from ifgen import resources
from ifgen.activation import overlays
from ifgen.config import installing
from ifgen.config.settings import settle
from ifgen.reading import manifest

Transport = Literal["local", "rclpy"]

_LAST_OF_DDS: Final = 232


class ActivationError(RuntimeError):
    """This process cannot use that transport; the text says why and what to do."""


def activate(
    transport: Literal["local", "rclpy", "auto"] = "auto", generated: str | Path | None = None
) -> Transport:
    """Let `import rclpy` and `import std_msgs.msg` find one transport's packages; returns which one.

    `local`: our rclpy and our message packages, even where a real ROS is installed. `rclpy`: the real ones;
    our packages only fill the gaps. `auto`: the real ones where they are installed, else `local`.
    `generated` is a folder with generated packages of yours, of messages and of nodes; None stands for
    `output` of the nearest pyproject.toml with `[tool.ifgen]`, or else for `generated`.
    Call it before the first import of either. Raises ActivationError if that is too late, if there is no real
    rclpy to use, or if there is no folder `generated`; InputError if `[tool.ifgen]` has mistakes.
    """
    if generated is not None and not Path(generated).is_dir():
        raise ActivationError(f"there is no folder '{generated}'; `ifgen generate -o {generated}` makes one")
    return put_on_path(transport, settle().output if generated is None else Path(generated))


def put_on_path(
    transport: Literal["local", "rclpy", "auto"], generated: Path | None, beside: Iterable[str] = ()
) -> Transport:
    """Do what `ifgen.activate` does, for the packages in one folder, which may not exist.

    `beside` are folders that programs will put before all others.
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
            f"or run `{installing.add_extra('ros')}` (Linux x86_64)"
        )
    if reason := reason_against_domain(chosen):
        raise ActivationError(reason)
    _refuse_mixture(chosen, real)
    own, bundled = import_folders(generated) if generated else [], str(resources.bundled_generated())
    libraries = str(resources.libraries())
    ros = [entry for entry in real if _has_ros(entry)]
    if chosen == "local":
        # The user's packages come before ours, except folders that contain a real ROS.
        users = [entry for entry in real if entry not in ros]
        sourced = [entry for entry in ros if _is_sourced(entry)]
        path = [str(resources.underlay()), *users, *own, bundled, *sourced, libraries, *ros]
    else:
        try:
            path = [*overlays.path_on_ros(real, ros, own, beside), bundled, libraries]
        except overlays.OverlayError as error:
            raise ActivationError(str(error)) from None
    sys.path[:] = dict.fromkeys(_with_nodes_of_examples(path, chosen))
    return chosen


def reason_against_domain(transport: str) -> str:
    """The reason why no program can start with ROS_DOMAIN_ID on a transport; empty if it can."""
    domains: Any = import_module("ifgen_runtime.domains")  # by name: the toolkit imports nothing of it
    text = os.environ.get("ROS_DOMAIN_ID")
    try:
        number: int = domains.of_environment()
    except ValueError:
        return f"ROS_DOMAIN_ID is {text!r}, expected a whole number, such as ROS_DOMAIN_ID=5"
    is_dds = transport == "rclpy" and "zenoh" not in os.environ.get("RMW_IMPLEMENTATION", "")
    if is_dds and number > _LAST_OF_DDS:
        return f"ROS_DOMAIN_ID is {text!r}, and the domains of DDS are 0 to {_LAST_OF_DDS}"
    return ""


def folder_around(path: Path) -> Path | None:
    """The folder of generated packages that a file is in, whatever it is called; None if it is in none."""
    for package in path.resolve().parents:
        if (package / manifest.NAME).is_file():
            return package.parent
    return None


def import_folders(generated: Path) -> list[str]:
    """The folders to put on `sys.path` for the packages in a folder: the folder, and each node package.

    The nodes of our own humanoid also need their library.
    """
    if not generated.is_dir():
        return []
    place = generated.resolve()
    libraries = [str(resources.humanoid())] if place == resources.bundled_nodes().resolve() else []
    return [str(place), *_folders_of_nodes(place), *libraries]


def _folders_of_nodes(generated: Path) -> list[str]:
    return [str(entry) for entry in sorted(generated.iterdir()) if is_node_package(entry)]


def is_node_package(folder: Path) -> bool:
    """Whether a generated package is laid out as nodes are: what Python imports is inside its folder."""
    return (folder / folder.name / "__init__.py").is_file() and (folder / manifest.NAME).is_file()


@cache
def _bundled_nodes() -> list[str]:
    nodes = resources.bundled_nodes().resolve()
    return _folders_of_nodes(nodes) if nodes.is_dir() else []


def _with_nodes_of_examples(path: Iterable[str], chosen: Transport) -> Iterator[str]:
    """The path with the packages of our humanoid's nodes: after `examples/humanoid`, if that is on it.

    Their names are such as `teleop` and `camera_driver`, which other projects have as well.
    """
    humanoid = resources.humanoid()
    for entry in path:
        yield entry
        if Path(entry).resolve() == humanoid:
            yield from _bundled_nodes()
            if chosen == "local":  # beside a real ROS they would hide its message packages
                yield str(resources.bundled_generated())


def _real_path() -> list[str]:
    """`sys.path` without our folders."""
    folders = (resources.underlay(), resources.bundled_generated(), resources.libraries())
    ours = {*map(str, folders), *_bundled_nodes()}
    return [entry for entry in sys.path if entry not in ours]


def _has_ros(entry: str) -> bool:
    """Whether a folder has packages of a real ROS that ours stand in for."""
    try:
        packages = [inside for inside in Path(entry).iterdir() if inside.name in _names()]
    except OSError:  # no such folder, or a zip file
        return False
    return any((p / "__init__.py").is_file() and not (p / manifest.NAME).exists() for p in packages)


def _is_sourced(entry: str) -> bool:
    """Whether a folder belongs to a sourced ROS or workspace for this Python: its libraries can be used."""
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    others = [part for part in Path(entry).parts if re.fullmatch(r"python3\.\d+", part) and part != version]
    prefixes = [place for place in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if place]
    return not others and any(Path(entry).is_relative_to(place) for place in prefixes)


def _finds(name: str, path: list[str]) -> bool:
    """Whether a package can be imported from a path; nothing is imported: the real rclpy takes long."""
    return importlib.machinery.PathFinder.find_spec(name, path) is not None


def _refuse_mixture(chosen: Transport, real: list[str]) -> None:
    for name in sorted(_names()):
        module = sys.modules.get(name)
        if module is None or _is_ours(module) == (chosen == "local"):
            continue
        if chosen == "rclpy" and not _finds(name, real):
            continue  # ours fills a gap
        found, wanted = ("ROS", "local transport") if chosen == "local" else ("local transport", "real rclpy")
        raise ActivationError(
            f"'{name}' is already imported from {_home(module)} ({found}), which does not match the "
            f"{wanted}: call ifgen.activate({chosen!r}) before the first import of rclpy or a message package"
        )


@cache
def _names() -> frozenset[str]:
    """The top-level packages that both transports have, except those of our examples."""
    folders = (resources.underlay(), resources.bundled_generated())
    found = (e.name for folder in folders if folder.is_dir() for e in folder.iterdir())
    packages = (name for name in found if any((f / name / "__init__.py").is_file() for f in folders))
    return frozenset(packages) - resources.EXAMPLE_INTERFACES


def _is_ours(module: ModuleType) -> bool:
    home = _home(module)
    return home is not None and (home.parent == resources.underlay() or (home / manifest.NAME).exists())


def _home(module: ModuleType) -> Path | None:
    """The folder of an imported package."""
    return Path(next(iter(module.__path__))) if hasattr(module, "__path__") else None

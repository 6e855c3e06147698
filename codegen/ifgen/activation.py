"""Chooses where `rclpy` and the message packages come from: our local transport, or the real ROS 2.

Two folders of top-level packages go on `sys.path`, and nothing else happens: no import hooks, no aliases.
All or nothing: a real `std_msgs` under our `rclpy`, or our `rcl_interfaces` under the real one, would fail in
ways that are hard to understand, so a mixture is refused.
"""

from __future__ import annotations

import importlib.machinery
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Literal

from ifgen import manifest, resources

Transport = Literal["local", "rclpy"]


class ActivationError(RuntimeError):
    """This process cannot use that transport; the text says why and what to do."""


def activate(transport: Literal["local", "rclpy", "auto"] = "auto") -> Transport:
    """Let `import rclpy` and `import std_msgs.msg` find one transport's packages, and say which one.

    `local`: our rclpy and our message packages, even where a real ROS is installed. `rclpy`: the real ones;
    our packages only fill the gaps. `auto`: the real ones where they are installed, else `local`.
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
    underlay, generated = str(resources.underlay()), str(resources.bundled_generated())
    sys.path[:] = [underlay, generated, *real] if chosen == "local" else [*real, generated]
    return chosen


def _real_path() -> list[str]:
    """`sys.path` without our two folders."""
    ours = {str(resources.underlay()), str(resources.bundled_generated())}
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
            yield from sorted(entry.name for entry in folder.iterdir() if entry.is_dir())


def _is_ours(module: ModuleType) -> bool:
    home = _home(module)
    return home is not None and (home.parent == resources.underlay() or (home / manifest.NAME).exists())


def _home(module: ModuleType) -> Path | None:
    """The folder of an imported package."""
    return Path(next(iter(module.__path__))) if hasattr(module, "__path__") else None

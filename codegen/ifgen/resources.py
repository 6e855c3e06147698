"""The places of the files that come with ifgen: in the packages that a wheel installs, else in a checkout."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

VERSION = "0.1.0"
"""The version of all our distributions."""

PACKAGE = Path(__file__).parent
"""The package `ifgen`: its code, and in a wheel the files that come with it."""

NODL_SCHEMA = "https://raw.githubusercontent.com/ifgen-ros/ifgen/main/docs/nodl.schema.json"
"""The address of the output of `ifgen nodl schema`, for editors."""

EXAMPLE_INTERFACES = frozenset({"humanoid_interfaces"})
"""The bundled interface packages that ROS does not have: a user may well have one of that name."""


def _beside_or(name: str, in_checkout: Path) -> Path:
    return PACKAGE / name if (PACKAGE / name).is_dir() else in_checkout


def _runtime() -> Any:
    # Found by name: the toolkit imports nothing of the runtime.
    return import_module("ifgen_runtime.importing")


def templates() -> Path:
    """The templates of generated files."""
    return _beside_or("templates", PACKAGE.parent.parent / "templates")


def skeleton(file: str, /, **values: str) -> str:
    """The first text of a file that `ifgen new` or `ifgen init` writes: `{key}` stands for a value."""
    text = (PACKAGE / "cli/skeletons" / file).read_text(encoding="utf-8")
    for key, value in values.items():
        text = text.replace(f"{{{key}}}", value)
    return text


def bundled_interfaces() -> Path:
    """The interface packages that come with ifgen, one folder each."""
    return _beside_or("interfaces", PACKAGE.parent.parent / "interfaces")


def bundled_generated() -> Path:
    """The packages of messages generated from the bundled interfaces."""
    folder: Path = _runtime().messages()
    return folder


@cache
def packages_of_ros() -> frozenset[str]:
    """The packages of messages that come with the runtime, and with every ROS."""
    packages = (path.parent.name for path in bundled_generated().glob("*/__init__.py"))
    return frozenset(packages) - EXAMPLE_INTERFACES


def bundled_nodes() -> Path:
    """The packages of nodes generated from the bundled interfaces; in a checkout with those of messages."""
    return _beside_or("generated", PACKAGE.parent.parent / "generated")


def examples() -> Path:
    """The example programs, the humanoid among them."""
    return _beside_or("examples", PACKAGE.parent.parent / "examples")


def humanoid() -> Path:
    """The library of our humanoid's nodes, and what brings them up."""
    return (examples() / "humanoid").resolve()


def rules_page() -> Path:
    """The page with every rule that a diagnostic may name."""
    beside = PACKAGE / "rules.md"
    return beside if beside.is_file() else PACKAGE.parent.parent / "docs/rules.md"


def underlay() -> Path:
    """The packages that nodes import where there is no ROS: rclpy and what it needs."""
    folder: Path = _runtime().underlay()
    return folder


def libraries() -> Path:
    """The packages that nodes import besides rclpy, for where there are no others."""
    folder: Path = _runtime().libraries()
    return folder


def cache_folder() -> Path:
    """The user's folder for what is kept between runs; to lose it at any time costs time only."""
    import platformdirs  # by far the slowest of what this module needs

    return platformdirs.user_cache_path("ifgen")

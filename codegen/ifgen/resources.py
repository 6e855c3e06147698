"""Where the files that come with ifgen are: in the packages that a wheel installs, else in a checkout."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path

_HERE = Path(__file__).parent

EXAMPLE_INTERFACES = frozenset({"humanoid_interfaces"})
"""The bundled interface packages that ROS does not have: a user may well have one of that name."""


def _beside_or(name: str, in_checkout: Path) -> Path:
    return _HERE / name if (_HERE / name).is_dir() else in_checkout


@cache
def _in_runtime(name: str, in_checkout: Path) -> Path:
    """A folder of the distribution that has `ifgen_runtime`, which is not imported for it."""
    spec = find_spec("ifgen_runtime")
    folder = Path(spec.origin).parent / name if spec and spec.origin else in_checkout
    return folder if folder.is_dir() else in_checkout


def templates() -> Path:
    """The templates of generated files."""
    return _beside_or("templates", _HERE.parent.parent / "templates")


def bundled_interfaces() -> Path:
    """The interface packages that come with ifgen, one folder each."""
    return _beside_or("interfaces", _HERE.parent.parent / "interfaces")


def bundled_generated() -> Path:
    """The packages of messages generated from the bundled interfaces."""
    return _in_runtime("generated", _HERE.parent.parent / "generated")


def bundled_nodes() -> Path:
    """The packages of nodes generated from the bundled interfaces; in a checkout with those of messages."""
    return _beside_or("generated", _HERE.parent.parent / "generated")


def examples() -> Path:
    """The example programs, the humanoid among them."""
    return _beside_or("examples", _HERE.parent.parent / "examples")


def rules_page() -> Path:
    """The page with every rule that a diagnostic may name."""
    beside = _HERE / "rules.md"
    return beside if beside.is_file() else _HERE.parent.parent / "docs/rules.md"


def underlay() -> Path:
    """The packages that nodes import where there is no ROS: rclpy and what it needs."""
    return _in_runtime("underlay", _HERE.parent / "underlay")


def cache_folder() -> Path:
    """The user's folder for what is kept between runs; to lose it at any time costs time only."""
    import platformdirs  # by far the slowest of what this module needs

    return platformdirs.user_cache_path("ifgen")

"""The folders of the runtime's packages, which messages and nodes need without ROS."""

from __future__ import annotations

import sys
from importlib.util import find_spec

TYPE_CHECKING = False  # typing itself takes longer to import than this module
if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["ensure_importable", "libraries", "messages", "underlay"]


def messages() -> Path:
    """The folder of our message packages; in a checkout those of nodes are beside them."""
    return _inside_or("generated", "../generated")


def underlay() -> Path:
    """The folder of our rclpy, and of what that needs besides messages."""
    return _inside_or("underlay", "underlay")


def libraries() -> Path:
    """The folder of what nodes import besides rclpy, such as `message_filters`."""
    return _inside_or("libraries", "libraries")


def ensure_importable(*packages: str) -> None:
    """Let packages of messages, `rclpy` and libraries of nodes be imported: ours, where there are no others.

    Generated packages that pip installs call it. No distribution may install a `std_msgs` or an `rclpy`,
    because it would hide the one of a ROS. So our folders go to the end of `sys.path`, after everything else.
    """
    missing = [name for name in packages if name not in sys.modules and find_spec(name) is None]
    if missing:
        folders = ([underlay()] if "rclpy" in missing else []) + [messages()]
        _append(folders)
    if "rclpy" in packages:  # of a package of nodes; a real rclpy need not have all of the libraries
        _append([libraries()])


def _append(folders: list[Path]) -> None:
    sys.path += [str(folder) for folder in folders if str(folder) not in sys.path]


def _inside_or(name: str, in_checkout: str) -> Path:
    """A folder beside this file in a wheel; in a checkout it is elsewhere."""
    from pathlib import Path  # takes longer to import than a message package, which may not need it

    here = Path(__file__).parent
    inside = here / name
    return inside if inside.is_dir() else (here.parent / in_checkout).resolve()

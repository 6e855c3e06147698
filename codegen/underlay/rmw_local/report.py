"""The way of a warning to the logger of a node, which only rclpy knows."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rmw_local.graph import GraphNode

Log = Callable[[str, str, bool], None]
"""Logs a text as the node with this full name: as a warning (True), or as information."""


def _on_stderr(node: str, text: str, is_warning: bool) -> None:
    if sys.stderr is not None:  # pythonw has none
        sys.stderr.write(f"rmw_local: {node}: {text}\n")


class _Installed:
    log: Log = staticmethod(_on_stderr)


def install(log: Log) -> None:
    """Log by this function from now on."""
    _Installed.log = staticmethod(log)


def say(node: GraphNode, text: str, *, is_warning: bool = True) -> None:
    """Log as a node. Called with no lock held."""
    _Installed.log(node.full_name, text, is_warning)

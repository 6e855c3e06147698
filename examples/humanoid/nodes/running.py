"""How each node's `main` runs it."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


def run(make: Callable[[], Node], args: list[str] | None = None) -> None:
    """Run a node until Ctrl-C or a shutdown from outside; a bad parameter or model file is one sentence."""
    rclpy.init(args=args)
    try:
        node = make()
    except (ValueError, RuntimeError) as error:
        rclpy.try_shutdown()
        sys.exit(f"error: {error}")
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()

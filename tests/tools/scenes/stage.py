"""What all scenes have in common."""

from __future__ import annotations

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def play(*nodes: Node) -> None:
    """Spin nodes until Ctrl-C or SIGTERM."""
    executor = MultiThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    print("ready", flush=True)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()

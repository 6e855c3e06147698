"""A program that looks at the graph until it is quiet, and writes down what it saw.

`ifgen graph` runs it after the other programs, so that they end with it. It imports rclpy by name, because
the toolkit does not depend on rclpy: it uses the chosen transport.
"""

from __future__ import annotations

import sys
import time
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ifgen.graph.model import SeenEndpoint
from ifgen.observing import graph_observation
from ifgen.observing.running_graph import endpoints

_QUIET = 1.0  # s without a change after which everybody has been discovered
_PATIENCE = 15.0  # s after which a graph that keeps changing is written as it is
_TURN = 0.05  # s


def main() -> None:
    """Look, wait, look again, and write."""
    rclpy: Any = import_module("rclpy")
    rclpy.init(args=[])
    # Hidden, as the command line tools of ROS are.
    node = rclpy.create_node("_ifgen_graph", start_parameter_services=False, enable_rosout=False)
    graph_observation.write(Path(sys.argv[1]), *settled(rclpy, node, int(sys.argv[2])))
    node.destroy_node()
    rclpy.try_shutdown()


def settled(rclpy: Any, node: Any, expected: int) -> tuple[tuple[str, ...], tuple[SeenEndpoint, ...]]:
    """The nodes and endpoints that `node` sees once nothing has changed for a while.

    `expected` is how many nodes there will be at least: programs that have just been started take a while.
    """
    seen = endpoints(node, _profiles(rclpy, node))
    started = since = time.monotonic()
    while (now := time.monotonic()) - started < _PATIENCE:
        if now - since > _QUIET and len(seen[0]) >= expected:
            break
        rclpy.spin_once(node, timeout_sec=_TURN)
        if (found := endpoints(node, _profiles(rclpy, node))) != seen:
            seen, since = found, time.monotonic()
    return seen


def _profiles(rclpy: Any, node: Any) -> dict[tuple[int, ...], Any]:
    """The whole QoS profiles of all ends of topics, on the local transport: they are in this process."""
    if find_spec("rmw_local") is None:
        return {}
    with node.handle:
        known = import_module("rclpy.impl.rcl.graph").whole_profiles(node.handle)
    return {gid: rclpy.qos.QoSProfile(**profile) for gid, profile in known.items()}


if __name__ == "__main__":
    main()

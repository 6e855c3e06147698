"""A robot of nodes for each test. These files need our rclpy: test_graph_faults.py runs each in a process."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from tests.humanoid.graph.robot import Robot

collect_ignore_glob = (
    [] if os.environ.get("IFGEN_INSIDE_GRAPH") else [str(Path(__file__).parent / "test_*.py")]
)


@pytest.fixture
def make_robot(ros_executor: Any) -> Iterator[Callable[..., Robot]]:
    """Make the robot of these nodes, with parameters by node."""
    from tests.humanoid.graph.robot import Robot

    robots: list[Robot] = []

    def make(*names: str, **parameters: Any) -> Robot:
        robots.append(Robot(names, ros_executor, **parameters))
        return robots[-1]

    yield make
    for robot in robots:
        robot.close()

"""Tests of what the node obstacle_mapper does. This file is yours: ifgen wrote it once, and leaves it alone.

`ros` comes from conftest.py: it runs nodes (`ros.start`, `ros.peer`), waits (`ros.spin_until`, `ros.result`)
and lets their time pass (`ros.pass_time`). What the description promises is tested beside this file.
"""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="source ROS, or use ifgen's pytest --transport local")

from obstacle_mapper.obstacle_mapper import ObstacleMapper


def test_start(ros: Any) -> None:
    """The node runs; say here what it should do."""
    node = ros.start(ObstacleMapper)
    assert node.get_name() == "obstacle_mapper"

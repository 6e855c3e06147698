"""Nodes to look at."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, String


@pytest.fixture
def talker() -> Iterator[Node]:
    """Two publishers on /chatter, a subscription to /robot/speed, and a hidden topic."""
    rclpy.init(args=[])
    node = rclpy.create_node("talker", start_parameter_services=False, enable_rosout=False)
    for _ in range(2):
        node.create_publisher(String, "chatter", 10)
    node.create_publisher(String, "_secret", 10)
    node.create_subscription(Float64, "robot/speed", lambda _: None, 10)
    yield node
    node.destroy_node()
    rclpy.shutdown()

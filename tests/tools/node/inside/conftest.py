"""A node to look at."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_msgs.msg import String


@pytest.fixture
def robot() -> Iterator[Node]:
    """`/lab/robot` with one of each, and something hidden."""
    rclpy.init(args=[])
    node = rclpy.create_node("robot", namespace="lab", start_parameter_services=False, enable_rosout=False)
    node.create_publisher(String, "chatter", 10)
    node.create_publisher(String, "_secret", 10)
    node.create_subscription(String, "/heard", lambda _: None, 10)
    node.create_service(AddTwoInts, "add", lambda _, response: response)
    node.create_client(AddTwoInts, "/other_add")
    server = ActionServer(node, Fibonacci, "count", lambda _: Fibonacci.Result())
    client = ActionClient(node, Fibonacci, "/other_count")
    yield node
    server.destroy()
    client.destroy()
    node.destroy_node()
    rclpy.shutdown()

"""A node with parameters of every type, which a thread runs."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
import rclpy
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.parameter import Parameter

VALUES = {
    "flag": True,
    "name": "hello",
    "foo.bar.text": "x",
    "foo.text": "5",
    "gains": [0.1, 2.5],
    "counts": [1, 2],
    "flags": [True, False],
    "names": ["a", "b"],
    "bytes": [b"a", b"\xff"],
}


@pytest.fixture
def robot() -> Iterator[Node]:
    """/robot/arm, a node without services for parameters, and a hidden one."""
    rclpy.init(args=[])
    node = Node("arm", namespace="/robot", enable_rosout=False)
    node.get_logger().set_level(
        LoggingSeverity.ERROR
    )  # what it refuses is its own log, beside the tool's words
    limits = [FloatingPointRange(from_value=0.0, to_value=2.5, step=0.1)]
    node.declare_parameter(
        "speed", 0.1, ParameterDescriptor(description="in m/s", floating_point_range=limits)
    )
    odd = ParameterDescriptor(
        integer_range=[IntegerRange(from_value=0, to_value=10)], additional_constraints="odd", read_only=True
    )
    node.declare_parameter("count", 3, odd)
    node.declare_parameter("unset", Parameter.Type.DOUBLE)
    node.declare_parameter("any", 7, ParameterDescriptor(dynamic_typing=True))
    for name, value in VALUES.items():
        node.declare_parameter(name, value)
    others = [Node("mute", start_parameter_services=False), Node("_secret", enable_rosout=False)]
    executor = SingleThreadedExecutor()
    for each in (node, *others):
        executor.add_node(each)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield node
    executor.shutdown()
    thread.join()
    for each in (node, *others):
        each.destroy_node()
    rclpy.shutdown()

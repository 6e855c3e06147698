"""Services to look at, and to call while a thread spins their node."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool


def add(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
    response.sum = request.a + request.b
    return response


@pytest.fixture
def server() -> Iterator[Node]:
    """`/adder` serves /add and a hidden service."""
    rclpy.init(args=[], signal_handler_options=rclpy.SignalHandlerOptions.NO)  # Ctrl-C is the tools'
    node = rclpy.create_node("adder", start_parameter_services=False, enable_rosout=False)
    node.create_service(AddTwoInts, "add", add)
    node.create_service(SetBool, "_secret", lambda _, response: response)
    yield node
    node.destroy_node()
    rclpy.try_shutdown()


@pytest.fixture
def spinning(server: Node) -> Iterator[Node]:
    """The same node, in a thread that spins it."""
    executor = SingleThreadedExecutor()
    executor.add_node(server)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield server
    executor.shutdown()
    thread.join(10.0)

"""Names in errors, reprs and pickles; what can be copied; the error of a call with a wrong keyword."""

import copy
import pickle

import rclpy
import rclpy._rclpy_pybind11 as extension
from rclpy.action import ActionClient, ActionServer
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.duration import Duration
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.time import Time
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.type_hash import TypeHash
from std_msgs.msg import String
from test_msgs.action import Fibonacci
from transcript import attempt


def names() -> None:
    """Everything in the extension module names that module as its home; errors survive pickling."""
    print(rclpy_implementation is extension)
    for name in sorted(dir(extension)):
        value = getattr(extension, name)
        if isinstance(value, type) and not name.startswith("_") and name not in ("Any", "EventsExecutor"):
            print(value.__module__, value.__qualname__)
            if issubclass(value, Exception):
                again = pickle.loads(pickle.dumps(value("text")))
                print(type(again) is value, again.args)
    for value in (ClientGoalHandle, ServerGoalHandle, Node, LifecycleNode):
        print(value.__module__, value.__qualname__)
    print(Node.create_timer.__qualname__, LifecycleNode.create_timer.__qualname__)


def wrong_calls() -> None:
    """The error names the class that users know."""
    rclpy.init()
    node = rclpy.create_node("n")
    client = ActionClient(node, Fibonacci, "fib")
    server = ActionServer(node, Fibonacci, "fib", lambda goal: Fibonacci.Result())
    publisher = node.create_publisher(String, "t", 1)
    for call in (
        node.create_publisher,
        node.create_subscription,
        node.create_client,
        node.create_service,
        node.create_timer,
        node.create_rate,
        node.destroy_publisher,
        node.declare_parameter,
        node.get_parameter,
        node.set_parameters,
        node.list_parameters,
        node.get_publishers_info_by_topic,
        node.count_publishers,
        node.get_logger,
        node.add_waitable,
        node.destroy_node,
        publisher.publish,
        client.send_goal_async,
        server.destroy,
        Node,
        rclpy.create_node,
        rclpy.spin_once,
        QoSProfile,
    ):
        attempt("keyword", lambda: call(nonsense=1))
        attempt("many", lambda: call(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17))
    for uuid in ("x", 7, b"0123456789abcdef"):
        attempt(f"goal_uuid {uuid!r}", lambda: client.send_goal_async(Fibonacci.Goal(), goal_uuid=uuid))
    attempt("get_result", lambda: client._get_result_async("no handle"))
    rclpy.shutdown()


def copies() -> None:
    """Objects that hold a part of the extension module can be neither copied nor pickled."""
    rclpy.init()
    node = rclpy.create_node("n")
    publisher = node.create_publisher(String, "t", 1)
    values = (QoSProfile(depth=1), Duration(seconds=1), Time(), TypeHash(), TopicEndpointInfo())
    for value in (
        *values,
        Parameter("p", value=1),
        String(data="s"),
        publisher,
        node.handle,
        node.get_clock(),
    ):
        name = type(value).__name__
        attempt(f"copy {name}", lambda: type(copy.copy(value)).__name__)
        attempt(f"deepcopy {name}", lambda: type(copy.deepcopy(value)).__name__)
        attempt(f"pickle {name}", lambda: type(pickle.loads(pickle.dumps(value))).__name__)
    rclpy.shutdown()


def main() -> None:
    names()
    wrong_calls()
    copies()

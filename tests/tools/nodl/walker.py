"""A node with something of everything, for `ifgen nodl describe`."""

import contextlib
import sys

import rclpy
from example_interfaces.action import Fibonacci
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.action import ActionClient, ActionServer
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from std_srvs.srv import Trigger


def main() -> None:
    rclpy.init(args=[])
    print("this is the program's own output")
    if "--lifecycle" in sys.argv:
        node: Node = LifecycleNode("manager")
        node.create_service(Trigger, "~/go", lambda _, response: response)
    else:
        node = walker()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)


def walker() -> Node:
    node = Node("walker", namespace="/robot")
    latched = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL, deadline=Duration(seconds=1))
    node.create_publisher(String, "~/a", latched)
    node.create_publisher(String, "/b", 10)
    node.create_subscription(
        String, "c", print, QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    )
    node.create_service(Trigger, "~/go", lambda _, response: response)
    node.create_client(Trigger, "/other/stop")
    node.server = ActionServer(node, Fibonacci, "fib", lambda _: Fibonacci.Result())
    node.caller = ActionClient(node, Fibonacci, "/other/fib")
    gain = FloatingPointRange(from_value=0.0, to_value=2.0)
    node.declare_parameter(
        "gain", 1.5, ParameterDescriptor(description="it's: how\nmuch", floating_point_range=[gain])
    )
    count = ParameterDescriptor(
        read_only=True, integer_range=[IntegerRange(from_value=-1, to_value=10, step=1)]
    )
    node.declare_parameter("n", 3, count)
    node.declare_parameter("a.names", ["x", "on"])
    node.declare_parameter("a.flags", [True])
    node.declare_parameter("a.raw", [b"\x01", b"\xff"])
    node.declare_parameter("inf", float("inf"))
    node.declare_parameter("unset", rclpy.Parameter.Type.DOUBLE)
    node.declare_parameter("bad-name", 1)
    node.declare_parameter("a", 1)
    return node


if __name__ == "__main__":
    main()

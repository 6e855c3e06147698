"""The nodes of the robot as programs: `programs.py NAME`. The planner says what it got."""

import contextlib
import sys
import threading

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64, String
from std_srvs.srv import Trigger

KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def driver(node: Node) -> None:
    scan = node.create_publisher(Float64, "scan", 10)
    node.create_timer(0.1, lambda: scan.publish(Float64(data=1.0)))

    def reset(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.message = "reset"
        return response

    node.create_service(Trigger, "~/reset", reset)


def mapper(node: Node) -> None:
    maps = node.create_publisher(String, "map", KEPT)
    node.create_subscription(Float64, "scan", lambda scan: maps.publish(String(data=f"of {scan.data}")), 10)


def mover(node: Node) -> None:
    def move(goal: ServerGoalHandle) -> Fibonacci.Result:
        goal.publish_feedback(Fibonacci.Feedback(sequence=[1]))
        goal.succeed()
        return Fibonacci.Result(sequence=[1, 1])

    ActionServer(node, Fibonacci, "move", move)


def planner(node: Node) -> None:
    node.create_subscription(String, "map", lambda found: print("map", found.data, flush=True), KEPT)

    def act() -> None:
        reset = node.create_client(Trigger, "driver/reset")
        reset.wait_for_service()
        print("service", reset.call(Trigger.Request()).message, flush=True)
        client = ActionClient(node, Fibonacci, "move")
        client.wait_for_server()
        told = client.send_goal(
            Fibonacci.Goal(order=1),
            feedback_callback=lambda it: print("feedback", *it.feedback.sequence, flush=True),
        )
        print("action", *told.result.sequence, flush=True)
        seen = sorted(name for name, _ in node.get_node_names_and_namespaces())
        print("nodes", *seen, flush=True)

    threading.Thread(target=act, daemon=True).start()


def stranger(node: Node) -> None:
    node.create_subscription(Float64, "scan", lambda scan: print("scan", scan.data, flush=True), 10)
    maps = node.create_publisher(String, "map", KEPT)
    node.create_timer(0.1, lambda: maps.publish(String(data="false")))
    print("here", flush=True)


rclpy.init()
name = sys.argv[1]
node = rclpy.create_node(name, namespace="robot")
globals()[name](node)
with contextlib.suppress(KeyboardInterrupt):
    rclpy.spin(node)

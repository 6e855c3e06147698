"""Remap rules of a process and of nodes, seen from the graph and by messages that arrive."""

from __future__ import annotations

from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool
from transcript import attempt, until

RULES = [
    "--ros-args",
    *("-r", "chatter:=talk"),
    *("-r", "listener:heard:=/talk"),
    *("-r", "rosservice://switch:=lamp/switch"),
    *("-r", "~/private:=open"),
    *("-r", "talker:__ns:=/left"),
    *("-r", "old_name:__node:=new_name"),
    *("-p", "new_name:number:=5"),
    *("-p", "number:=1"),
    "--",
    "an_argument",
]


def make_nodes() -> tuple[Node, Node, Node, Node]:
    """Create nodes that the rules rename, move and leave alone."""
    talker = rclpy.create_node("talker")
    listener = rclpy.create_node(
        "listener", namespace="/left", cli_args=["--ros-args", "-r", "back:=/left/open"]
    )
    renamed = rclpy.create_node("old_name", automatically_declare_parameters_from_overrides=True)
    alone = rclpy.create_node(
        "alone", use_global_arguments=False, cli_args=["--ros-args", "-r", "__ns:=/deep/er"]
    )
    nodes = (talker, listener, renamed, alone)
    for node in nodes:
        print(node.get_fully_qualified_name(), node.get_logger().name)
    print(renamed.get_parameter("number").value, alone.has_parameter("number"))
    return nodes


def topics(executor: SingleThreadedExecutor, nodes: tuple[Node, Node, Node, Node]) -> None:
    """Publish on names that only the rules bring together."""
    talker, listener, _, alone = nodes
    heard: list[str] = []

    def hear(message: String) -> None:
        heard.append(message.data)

    publisher = talker.create_publisher(String, "chatter", 10)
    private = talker.create_publisher(String, "~/private", 10)
    for name in ("chatter", "heard", "back"):
        listener.create_subscription(String, name, hear, 10)
    for name in ("chatter", "/left/talk"):
        alone.create_subscription(String, name, hear, 10)
    subscribed = [each.topic_name for node in nodes for each in node.subscriptions]
    print(publisher.topic_name, private.topic_name, subscribed)

    def matched() -> bool:
        return publisher.get_subscription_count() == 2 and private.get_subscription_count() == 1

    print(until(matched, executor))
    publisher.publish(String(data="by chatter"))
    print(until(lambda: len(heard) == 2, executor))
    private.publish(String(data="by private"))
    print(until(lambda: len(heard) == 3, executor), heard)


def services(executor: SingleThreadedExecutor, talker: Node, listener: Node) -> None:
    """Call a service under its remapped name."""

    def answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success = request.data
        response.message = "switched"
        return response

    talker.create_service(SetBool, "switch", answer)
    client = listener.create_client(SetBool, "switch")
    print(client.srv_name, client.service_name, client.wait_for_service(10))
    future = client.call_async(SetBool.Request(data=True))
    executor.spin_until_future_complete(future, 10)
    print(future.result().success, future.result().message)


def graph(talker: Node, listener: Node) -> None:
    """Ask the graph by names before and after remapping."""

    def known(name_and_types: Any) -> bool:
        return "talk" in name_and_types[0] or "lamp" in name_and_types[0] or "open" in name_and_types[0]

    print([each for each in talker.get_topic_names_and_types() if known(each)])
    print([each for each in talker.get_service_names_and_types() if "lamp" in each[0]])
    for name in ("chatter", "talk", "/left/talk", "~/private", "open"):
        attempt(
            f"count {name}", lambda name=name: (talker.count_publishers(name), talker.count_subscribers(name))
        )
        attempt(f"info {name}", lambda name=name: len(talker.get_publishers_info_by_topic(name)))
        attempt(f"info {name}", lambda name=name: len(listener.get_subscriptions_info_by_topic(name)))
    attempt("services", lambda: (talker.count_services("switch"), talker.count_services("lamp/switch")))
    attempt("by node", lambda: listener.get_client_names_and_types_by_node("listener", "/left"))
    attempt("names", lambda: sorted(talker.get_fully_qualified_node_names()))


def main() -> None:
    """A talker and a listener find each other only through the rules."""
    rclpy.init(args=["program", *RULES])
    print(rclpy.utilities.remove_ros_args(["program", *RULES]))
    nodes = make_nodes()
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    talker, listener, _, _ = nodes
    topics(executor, nodes)
    services(executor, talker, listener)
    graph(talker, listener)
    executor.shutdown()
    for node in nodes:
        node.destroy_node()
    rclpy.shutdown()

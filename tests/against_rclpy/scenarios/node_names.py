"""Names: validation with its carets, expansion, remapping, and what entities make of them."""

from __future__ import annotations

from itertools import product

import rclpy
from rclpy.context import Context
from rclpy.expand_topic_name import expand_topic_name
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name
from std_msgs.msg import String
from std_srvs.srv import Empty
from transcript import attempt

NAMES = (
    "", "a", "a b", "a//b", "/a//b", "{bad}/z", "{ns}/y", "~", "~/x", "~x", "~xy", "/", "a/", "/a/", "1a", "a/1", "{node}",
    "__x", "_x", "a" * 300, "/" + "a" * 247, "/" + "a" * 245, "{1a}", "{a b}", "a{b", "a}b", "~{node}", "~/{node}", "a/~",
    "{node}{ns}", "/x{node}", "é", "a\tb", "{}", "{namespace}", "x{node}y", "x",
)  # fmt: skip


def validators() -> None:
    """Every short name over an alphabet of the interesting characters, and the texts of the exceptions."""
    functions = (
        _rclpy.rclpy_get_validation_error_for_full_topic_name,
        _rclpy.rclpy_get_validation_error_for_topic_name,
        _rclpy.rclpy_get_validation_error_for_namespace,
        _rclpy.rclpy_get_validation_error_for_node_name,
    )
    for function in functions:
        for length in range(5):
            for letters in product("a1_/~{} ", repeat=length):
                if answer := function("".join(letters)):
                    print("".join(letters), answer)
    for name in NAMES:
        attempt(f"node {name[:9]}", lambda name=name: validate_node_name(name))
        attempt(f"namespace {name[:9]}", lambda name=name: validate_namespace(name))
        attempt(f"topic {name[:9]}", lambda name=name: validate_topic_name(name))
        attempt(f"service {name[:9]}", lambda name=name: validate_topic_name(name, is_service=True))
        attempt(f"full {name[:9]}", lambda name=name: validate_full_topic_name(name))
        attempt(f"full service {name[:9]}", lambda name=name: validate_full_topic_name(name, is_service=True))
        attempt(f"parameter {name[:9]}", lambda name=name: validate_parameter_name(name))
        attempt(f"hidden {name[:9]}", lambda name=name: topic_or_service_is_hidden(name))
        for node, namespace in (("n", "/"), ("n", "/ns"), ("1n", "/"), ("n", "ns"), ("n", "/ns/"), ("n", "")):
            attempt(
                f"expand {name[:9]} {node} {namespace}",
                lambda name=name, node=node, namespace=namespace: expand_topic_name(name, node, namespace),
            )


def in_a_node() -> None:
    """Resolving and creating with every name, under remap rules."""
    context = Context()
    context.init(args=["--ros-args", "-r", "x:=y", "-r", "/n1/x:=/z", "-r", "a:=~/q"])
    node = rclpy.create_node("n1", context=context)
    for name in NAMES:
        short = name[:9]
        attempt(f"topic {short}", lambda name=name: node.resolve_topic_name(name))
        attempt(f"only {short}", lambda name=name: node.resolve_topic_name(name, only_expand=True))
        attempt(f"service {short}", lambda name=name: node.resolve_service_name(name))
        attempt(f"pub {short}", lambda name=name: node.create_publisher(String, name, 1).topic_name)
        attempt(
            f"sub {short}",
            lambda name=name: node.create_subscription(String, name, lambda _: None, 1).topic_name,
        )
        attempt(f"client {short}", lambda name=name: node.create_client(Empty, name).srv_name)
        attempt(
            f"server {short}", lambda name=name: node.create_service(Empty, name, lambda _, r: r).srv_name
        )
        attempt(f"count {short}", lambda name=name: node.count_publishers(name))
        attempt(f"count services {short}", lambda name=name: node.count_services(name))
        attempt(f"info {short}", lambda name=name: len(node.get_subscriptions_info_by_topic(name)))
    node.destroy_node()
    context.shutdown()


def node_names() -> None:
    """The names that nodes can have."""
    for name, namespace in (
        ("1n", ""), ("n", "1"), ("n", "/a/"), ("n", "a"), ("n", ""), ("", "/"), ("a b", ""), ("n", "/a b"), ("n" * 256, ""),
        ("n", "/" + "n" * 250), ("n", "//"), ("n" * 255, ""), ("_n", "/_a"), ("n", None),
    ):  # fmt: skip
        context = Context()
        context.init()

        def create(name: str = name, namespace: str | None = namespace, context: Context = context) -> str:
            node = rclpy.create_node(name, namespace=namespace, context=context)
            described = f"{node.get_fully_qualified_name()} {node.get_namespace()} {node.get_logger().name}"
            node.destroy_node()
            return described

        attempt(f"create {name[:5]} {namespace}", create)
        context.shutdown()


def main() -> None:
    """Print all of it."""
    validators()
    in_a_node()
    node_names()

"""Entities that a node creates and destroys, their errors, and the rest of a destroyed node or context."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.guard_condition import GuardCondition
from rclpy.node import HIDDEN_NODE_PREFIX, Node, NodeNameNonExistentError
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from std_msgs.msg import String
from std_srvs.srv import Empty
from transcript import attempt


def nothing(*_: Any) -> None:
    """Do nothing."""


def bare(node: Node) -> None:
    """A newly created node."""
    attempt("names", lambda: (node.get_name(), node.get_namespace(), node.get_fully_qualified_name()))
    attempt("publishers", lambda: [each.topic_name for each in node.publishers])
    attempt("services", lambda: [each.srv_name for each in node.services])
    for kind in ("subscriptions", "clients", "timers", "guards", "waitables"):
        attempt(kind, lambda kind=kind: len(list(getattr(node, kind))))
    attempt("iterators", lambda: type(node.publishers).__name__)
    attempt("parameters", lambda: sorted(node.get_parameters_by_prefix("")))
    attempt("logger", lambda: node.get_logger().name)
    attempt("clock", lambda: (type(node.get_clock()).__name__, node.get_clock().clock_type))
    attempt("group", lambda: type(node.default_callback_group).__name__)
    attempt("executor", lambda: node.executor)
    attempt("context", lambda: node.context is rclpy.get_default_context())
    attempt("handle", lambda: setattr(node, "handle", 1))
    attempt("handle", lambda: type(node.handle).__name__)
    attempt("use count", node.handle.__enter__)
    attempt("use count", lambda: node.handle.__exit__(None, None, None))
    attempt("hidden", lambda: HIDDEN_NODE_PREFIX)
    attempt("error", lambda: [each.__name__ for each in NodeNameNonExistentError.__mro__])
    with node.handle:
        attempt("below", lambda: (node.handle.get_node_name(), node.handle.logger_name()))


def creating(node: Node) -> None:
    """Good and bad arguments."""
    publisher = attempt("pub", lambda: node.create_publisher(String, "t", 1), lambda each: each.topic_name)
    attempt("qos", lambda: node.create_publisher(String, "t", "x"))
    attempt("qos", lambda: node.create_publisher(String, "t", -1))
    attempt("qos", lambda: node.create_publisher(String, "t", None))
    attempt("qos", lambda: node.create_publisher(String, "t", True).qos_profile.depth)
    attempt("qos", lambda: node.create_publisher(String, "t", qos_profile_sensor_data).qos_profile.depth)
    attempt("qos", lambda: node.create_publisher(String, "t", QoSProfile(depth=0)).qos_profile.depth)
    attempt("qos", lambda: node.create_client(Empty, "t", qos_profile=5))
    attempt("type", lambda: node.create_publisher(int, "t", 1))
    attempt("type", lambda: node.create_publisher(Empty, "t", 1))
    attempt("type", lambda: node.create_subscription(Empty, "t", nothing, 1))
    attempt("type", lambda: node.create_client(String, "t"))
    attempt("type", lambda: node.create_service(String, "t", nothing))
    attempt("callback", lambda: node.create_subscription(String, "t", None, 1))
    attempt("callback", lambda: node.create_subscription(String, "t", lambda: 0, 1))
    attempt("callback", lambda: node.create_subscription(String, "t", lambda a, b, c: 0, 1))
    attempt("callback", lambda: type(node.create_service(Empty, "s", None)).__name__)
    attempt("timer", lambda: node.create_timer(-1, nothing))
    attempt("timer", lambda: node.create_timer("x", nothing))
    attempt("timer", lambda: node.create_timer("0.5", nothing).timer_period_ns)
    attempt("timer", lambda: node.create_timer(0.1, nothing, clock=Clock()).clock.clock_type)
    attempt("timer", lambda: node.create_timer(1, nothing, autostart=False).is_canceled())
    attempt("timer", lambda: node.create_timer(1, nothing).clock is node.get_clock())
    attempt("rate", lambda: node.create_rate(0))
    attempt("rate", lambda: node.create_rate(-1.0))
    attempt("guard", lambda: type(node.create_guard_condition(nothing)).__name__)
    group = ReentrantCallbackGroup()
    subscription = node.create_subscription(String, "t", nothing, 1, callback_group=group)
    attempt("group", lambda: (group.has_entity(subscription), subscription.callback_group is group))
    attempt("group", lambda: node.default_callback_group.has_entity(subscription))

    class Special(Publisher):
        """A publisher of one's own."""

    attempt("class", lambda: type(node.create_publisher(String, "t", 1, publisher_class=Special)).__name__)

    class Broken(Publisher):
        """A publisher that cannot be made."""

        def __init__(self, *args: Any, **kwargs: Any) -> None:
            raise ValueError("broken")

    before = len(list(node.publishers))
    attempt("class", lambda: node.create_publisher(String, "t", 1, publisher_class=Broken))
    attempt("unchanged", lambda: len(list(node.publishers)) == before)
    attempt("counts", lambda: [len(list(getattr(node, kind))) for kind in ("timers", "guards", "clients")])
    attempt("destroy", lambda: node.destroy_publisher(publisher))


def destroy_one(node: Node, other: Node, kind: str, make: Callable[[Node], Any]) -> None:
    """Destroy one kind of entity: the node's own one and one of another node."""
    destroy = getattr(node, f"destroy_{kind}")
    waitables = len(list(node.waitables))
    mine, foreign = make(node), make(other)
    attempt(f"{kind} more waitables", lambda: len(list(node.waitables)) - waitables)
    attempt(f"{kind} foreign", lambda: destroy(foreign))
    attempt(f"{kind} wrong", lambda: destroy(3))
    attempt(f"{kind}", lambda: destroy(mine))
    attempt(f"{kind} again", lambda: destroy(mine))
    attempt(f"{kind} waitables", lambda: len(list(node.waitables)) - waitables)
    attempt(f"{kind} itself", foreign.destroy)
    attempt(f"{kind} itself again", foreign.destroy)
    attempt(f"{kind} handle", mine.handle.__enter__)


def destroying(node: Node) -> None:
    """Destroy entities twice, foreign ones, and use destroyed ones."""
    other = rclpy.create_node("other")
    makers: dict[str, Any] = {
        "publisher": lambda of: of.create_publisher(String, "d", 1),
        "subscription": lambda of: of.create_subscription(String, "d", nothing, 1),
        "client": lambda of: of.create_client(Empty, "d"),
        "service": lambda of: of.create_service(Empty, "d", nothing),
        "timer": lambda of: of.create_timer(1, nothing),
        "guard_condition": lambda of: of.create_guard_condition(nothing),
    }
    for kind, make in makers.items():
        destroy_one(node, other, kind, make)
    rate = node.create_rate(10.0)
    attempt("rate", lambda: node.destroy_rate(rate))
    attempt("rate", lambda: node.destroy_rate(rate))
    attempt("rate", rate.sleep)
    attempt("other", other.destroy_node)


def graph(node: Node) -> None:
    """Graph queries that need no second node."""
    attempt("own", lambda: node.get_publisher_names_and_types_by_node("entities", "/"))
    attempt("services", lambda: len(node.get_service_names_and_types_by_node("entities", "/")))
    attempt("clients", lambda: node.get_client_names_and_types_by_node("entities", "/"))
    for call in (
        node.get_publisher_names_and_types_by_node,
        node.get_subscriber_names_and_types_by_node,
        node.get_service_names_and_types_by_node,
        node.get_client_names_and_types_by_node,
    ):
        attempt("nobody", lambda call=call: call("nobody", "/"))
        attempt("bad name", lambda call=call: call("a b", "/"))
        attempt("bad namespace", lambda call=call: call("a", "x y"))
    attempt("wait", lambda: node.wait_for_node("entities", 5.0))
    attempt("wait", lambda: node.wait_for_node("/entities", 5.0))
    attempt("wait", lambda: node.wait_for_node("/nobody", 0.1))
    attempt("enclaves", lambda: ("entities", "/", "/") in node.get_node_names_and_namespaces_with_enclaves())
    attempt("names", lambda: "/entities" in node.get_fully_qualified_node_names())


def executors(node: Node) -> None:
    """A node belongs to one executor at a time."""
    first: Any = SingleThreadedExecutor()
    second: Any = SingleThreadedExecutor()
    attempt("add", lambda: first.add_node(node))
    attempt("add", lambda: first.add_node(node))
    attempt("is", lambda: node.executor is first)
    node.executor = second
    attempt("moved", lambda: (node.executor is second, node in first.get_nodes(), node in second.get_nodes()))
    node.executor = second
    node.executor = None
    attempt("none", lambda: (node.executor, node in second.get_nodes()))
    second.add_node(node)
    second = None
    gc.collect()
    attempt("weak", lambda: node.executor)
    first.shutdown()


def gone(node: Node) -> None:
    """A destroyed node."""
    publisher = node.create_publisher(String, "late", 1)
    attempt("destroy", node.destroy_node)
    attempt("destroy", node.destroy_node)
    for call in (
        node.get_name, node.get_namespace, node.get_fully_qualified_name, node.get_node_names, node.get_topic_names_and_types,
    ):  # fmt: skip
        attempt(call.__name__, call)
    attempt("publish", lambda: publisher.publish(String()))
    attempt("pub", lambda: node.create_publisher(String, "q", 1))
    attempt("sub", lambda: node.create_subscription(String, "q", nothing, 1))
    attempt("client", lambda: node.create_client(Empty, "q"))
    attempt("service", lambda: node.create_service(Empty, "q", nothing))
    attempt("timer", lambda: type(node.create_timer(1, nothing)).__name__)
    attempt("count", lambda: node.count_publishers("q"))
    attempt("resolve", lambda: node.resolve_topic_name("q"))
    attempt("logger", lambda: node.get_logger().name)
    attempt("parameter", lambda: node.get_parameter("use_sim_time").value)
    attempt("declare", lambda: node.declare_parameter("zz", 1))
    attempt(
        "lists", lambda: [len(list(each)) for each in (node.publishers, node.subscriptions, node.services)]
    )


def without_context() -> None:
    """Contexts that are shut down."""
    context = Context()
    attempt("not up", lambda: rclpy.create_node("n", context=context))
    context.init()
    node = rclpy.create_node("n", context=context)
    publisher = node.create_publisher(String, "q", 1)
    context.shutdown()
    attempt("down", lambda: rclpy.create_node("n", context=context))
    attempt("pub", lambda: node.create_publisher(String, "q", 1))
    attempt("timer", lambda: node.create_timer(1, nothing))
    attempt("guard", lambda: GuardCondition(nothing, MutuallyExclusiveCallbackGroup(), context=context))
    attempt("publish", lambda: publisher.publish(String()))
    attempt("names", node.get_node_names)
    attempt("name", node.get_name)
    attempt("resolve", lambda: node.resolve_topic_name("q"))
    attempt("set", lambda: node.set_parameters([Parameter("use_sim_time", value=False)]))
    attempt("destroy", node.destroy_node)


def collected() -> None:
    """A destroyed node leaves nothing behind that keeps it alive."""
    node = rclpy.create_node("collected", start_parameter_services=False)
    reference = weakref.ref(node)
    node.destroy_node()
    del node
    gc.collect()
    attempt("collected", lambda: reference() is None)


def main() -> None:
    """Print all of it."""
    attempt("before init", lambda: rclpy.create_node("n"))
    rclpy.init()
    node = rclpy.create_node("entities")
    bare(node)
    creating(node)
    destroying(node)
    graph(node)
    executors(node)
    gone(node)
    without_context()
    collected()
    plain = rclpy.create_node(
        "plain", enable_rosout=False, start_parameter_services=False, enable_logger_service=True
    )
    attempt("services", lambda: [each.srv_name for each in plain.services])
    attempt("topics", lambda: plain.get_publisher_names_and_types_by_node("plain", "/"))
    plain.destroy_node()
    rclpy.shutdown()

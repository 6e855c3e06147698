"""Wrong values in place of each argument of public calls: the same exception class, or none, on both."""

import contextlib
import os
from collections.abc import Callable, Iterator
from typing import Any

import rclpy
import rclpy.executors
import rclpy.node
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.task import Future
from rclpy.time import Time
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name
from std_msgs.msg import String
from test_msgs.action import Fibonacci
from test_msgs.srv import Empty


def wrong_values() -> tuple[object, ...]:
    """Make new values: a call may keep one and change it."""
    return (None, object(), "text", "", -1, 1.5, True, [], [1], {}, b"x", String, String(), print)


def name_of(value: object) -> str:
    """Name a wrong value."""
    return "object()" if type(value) is object else getattr(value, "__name__", None) or repr(value)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Hide log output, because there is a lot of it."""
    kept = os.dup(2)
    with open(os.devnull, "w") as nothing:  # noqa: PTH123 - it is no path
        os.dup2(nothing.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def outcome(call: Callable[[], Any], undo: Callable[[Any], Any] | None) -> str:
    """Return what a call raises; undo the call if it raises nothing."""
    try:
        made = call()
    except Exception as error:
        return type(error).__name__
    try:
        if undo is not None:
            undo(made)
    except Exception as error:
        return f"-{type(error).__name__}"
    return "-"


Call = tuple[Callable[..., Any], dict[str, Any], Callable[[Any], Any] | None]
NO_GROUP: dict[str, Any] = {"callback_group": None}


def calls(node: rclpy.node.Node) -> Iterator[Call]:
    """Yield calls, arguments that fit, and functions that undo the calls."""
    timer = node.create_timer(100.0, print)
    yield from of_entities(node, timer)
    yield from of_nodes(node)
    yield from of_values()
    yield from of_executors(node, timer)


def of_entities(node: rclpy.node.Node, timer: rclpy.node.Timer) -> Iterator[Call]:
    """Calls of the entities that nodes create."""
    publisher = node.create_publisher(String, "wrong", 1)
    client = node.create_client(Empty, "wrong")
    yield (
        node.create_publisher,
        {
            "msg_type": String,
            "topic": "t",
            "qos_profile": 1,
            **NO_GROUP,
            "event_callbacks": None,
            "qos_overriding_options": None,
        },
        node.destroy_publisher,
    )
    yield (
        node.create_subscription,
        {
            "msg_type": String,
            "topic": "t",
            "callback": print,
            "qos_profile": 1,
            **NO_GROUP,
            "event_callbacks": None,
            "qos_overriding_options": None,
            "raw": False,
        },
        node.destroy_subscription,
    )
    yield (
        node.create_client,
        {"srv_type": Empty, "srv_name": "s", "qos_profile": QoSProfile(depth=1), **NO_GROUP},
        node.destroy_client,
    )
    yield (
        node.create_service,
        {
            "srv_type": Empty,
            "srv_name": "s",
            "callback": print,
            "qos_profile": QoSProfile(depth=1),
            **NO_GROUP,
        },
        node.destroy_service,
    )
    yield (
        node.create_timer,
        {"timer_period_sec": 100.0, "callback": print, **NO_GROUP, "clock": None, "autostart": True},
        node.destroy_timer,
    )
    yield node.create_guard_condition, {"callback": print, **NO_GROUP}, node.destroy_guard_condition
    yield node.create_rate, {"frequency": 1.0, "clock": None}, node.destroy_rate
    for destroy in (
        node.destroy_publisher,
        node.destroy_subscription,
        node.destroy_client,
        node.destroy_service,
        node.destroy_timer,
        node.destroy_guard_condition,
        node.destroy_rate,
    ):
        yield lambda entity, destroy=destroy: destroy(entity), {"entity": timer}, None
    yield publisher.publish, {"msg": String()}, None
    yield client.call_async, {"request": Empty.Request()}, None
    yield client.wait_for_service, {"timeout_sec": 0.0}, None
    yield client.remove_pending_request, {"future": Future()}, None
    yield (
        ActionClient,
        {"node": node, "action_type": Fibonacci, "action_name": "a", **NO_GROUP},
        lambda made: made.destroy(),
    )
    yield (
        ActionServer,
        {
            "node": node,
            "action_type": Fibonacci,
            "action_name": "a",
            "execute_callback": print,
            **NO_GROUP,
            "goal_callback": print,
            "handle_accepted_callback": print,
            "cancel_callback": print,
            "result_timeout": 10,
        },
        lambda made: made.destroy(),
    )


def of_nodes(node: rclpy.node.Node) -> Iterator[Call]:
    """Nodes, parameters and the graph."""
    yield (
        rclpy.node.Node,
        {
            "node_name": "n",
            "context": None,
            "cli_args": None,
            "namespace": None,
            "use_global_arguments": True,
            "enable_rosout": True,
            "parameter_overrides": None,
            "allow_undeclared_parameters": False,
        },
        lambda made: made.destroy_node(),
    )
    yield (
        node.declare_parameter,
        {
            "name": "p",
            "value": 1,
            "descriptor": ParameterDescriptor(dynamic_typing=True),
            "ignore_override": False,
        },
        lambda made: node.undeclare_parameter(made.name),
    )
    yield (
        node.declare_parameters,
        {"namespace": "n", "parameters": [("p", 1)]},
        lambda made: [node.undeclare_parameter(each.name) for each in made],
    )
    for ask in (
        node.undeclare_parameter,
        node.has_parameter,
        node.get_parameter,
        node.describe_parameter,
        node.get_parameter_type,
    ):
        yield ask, {"name": "q"}, None
    for ask in (node.get_parameters, node.describe_parameters, node.get_parameter_types):
        yield ask, {"names": ["q"]}, None
    yield node.get_parameters_by_prefix, {"prefix": "q"}, None
    yield node.list_parameters, {"prefixes": ["q"], "depth": 0}, None
    for change in (node.set_parameters, node.set_parameters_atomically):
        yield change, {"parameter_list": [Parameter("q", value=1)]}, None
    for add in (
        node.add_on_set_parameters_callback,
        node.add_pre_set_parameters_callback,
        node.add_post_set_parameters_callback,
    ):
        remove = getattr(node, add.__name__.replace("add", "remove"))
        yield remove, {"callback": print}, None
    for ask in (
        node.count_publishers,
        node.count_subscribers,
        node.get_publishers_info_by_topic,
        node.get_subscriptions_info_by_topic,
    ):
        yield ask, {"topic_name": "t"}, None
    for ask in (node.count_clients, node.count_services):
        yield ask, {"service_name": "t"}, None
    yield node.resolve_topic_name, {"topic": "t"}, None
    yield node.resolve_service_name, {"service": "t"}, None
    for ask in (node.get_publisher_names_and_types_by_node, node.get_service_names_and_types_by_node):
        yield ask, {"node_name": node.get_name(), "node_namespace": "/"}, None
    yield node.wait_for_node, {"fully_qualified_node_name": "/x", "timeout": 0.0}, None
    yield rclpy.create_node, {"node_name": "n"}, lambda made: made.destroy_node()
    yield (
        rclpy.init,
        {"args": [], "context": rclpy.Context(), "domain_id": None, "signal_handler_options": None},
        None,
    )


def of_values() -> Iterator[Call]:
    """Time, QoS, messages and names."""
    time, duration, clock = Time(seconds=1), Duration(seconds=1), Clock()
    yield Parameter, {"name": "p", "type_": Parameter.Type.INTEGER, "value": 1}, None
    yield Parameter.from_parameter_msg, {"param_msg": Parameter("p", value=1).to_parameter_msg()}, None
    yield parameter_value_to_python, {"parameter_value": Parameter("p", value=1).get_parameter_value()}, None
    # Both multiply seconds by 10**9: a text becomes gigabytes.
    yield Duration, {"nanoseconds": 1}, None
    yield Time, {"nanoseconds": 1, "clock_type": ClockType.ROS_TIME}, None
    for operation in ("__add__", "__sub__", "__eq__", "__lt__", "__ge__"):
        yield getattr(time, operation), {"other": duration}, None
    for operation in ("__eq__", "__lt__", "__ge__"):
        yield getattr(duration, operation), {"other": duration}, None
    yield Time.from_msg, {"msg": time.to_msg(), "clock_type": ClockType.ROS_TIME}, None
    yield Duration.from_msg, {"msg": duration.to_msg()}, None
    yield Clock, {"clock_type": ClockType.ROS_TIME}, None
    yield clock.sleep_for, {"rel_time": Duration()}, None
    yield clock.sleep_until, {"until": Time(clock_type=clock.clock_type)}, None
    yield (
        JumpThreshold,
        {"min_forward": duration, "min_backward": Duration(seconds=-1), "on_clock_change": True},
        None,
    )
    yield (
        QoSProfile,
        {
            "depth": 1,
            "history": 1,
            "reliability": 1,
            "durability": 1,
            "lifespan": duration,
            "deadline": duration,
            "liveliness": 1,
            "liveliness_lease_duration": duration,
            "avoid_ros_namespace_conventions": False,
        },
        None,
    )
    yield QoSOverridingOptions, {"policy_kinds": [], "callback": None, "entity_id": None}, None
    yield serialize_message, {"message": String()}, None
    yield (
        deserialize_message,
        {"serialized_message": serialize_message(String()), "message_type": String},
        None,
    )
    for validate, argument in (
        (validate_node_name, "node_name"),
        (validate_namespace, "namespace"),
        (validate_parameter_name, "name"),
        (validate_topic_name, "name"),
        (validate_full_topic_name, "name"),
    ):
        yield (
            validate,
            {argument: "/a" if validate in (validate_namespace, validate_full_topic_name) else "a"},
            None,
        )


def of_executors(node: rclpy.node.Node, timer: rclpy.node.Timer) -> Iterator[Call]:
    """Loggers, executors and other objects that are not nodes."""
    executor = rclpy.executors.SingleThreadedExecutor()
    yield rclpy.logging.get_logger, {"name": "x"}, None
    yield rclpy.logging.set_logger_level, {"name": "x", "level": 10}, None
    yield rclpy.logging.get_logger_effective_level, {"name": "x"}, None
    yield rclpy.logging.get_logging_severity_from_string, {"log_severity": "INFO"}, None
    yield node.get_logger().get_child, {"name": "x"}, None
    yield node.get_logger().set_level, {"level": 10}, None
    yield node.get_logger().is_enabled_for, {"severity": 10}, None
    yield executor.add_node, {"node": node}, lambda made: executor.remove_node(node)
    yield executor.remove_node, {"node": node}, None
    yield executor.spin_once, {"timeout_sec": 0}, None
    yield rclpy.executors.SingleThreadedExecutor, {"context": None}, lambda made: made.shutdown()
    yield rclpy.executors.MultiThreadedExecutor, {"num_threads": 2}, lambda made: made.shutdown()
    yield rclpy.spin_once, {"node": node, "timeout_sec": 0}, None
    yield AsyncParameterClient, {"node": node, "remote_node_name": "x"}, None
    yield ParameterEventHandler, {"node": node}, lambda made: made.destroy()
    for made in (MutuallyExclusiveCallbackGroup(), ReentrantCallbackGroup()):
        yield made.add_entity, {"entity": timer}, None
        yield made.has_entity, {"entity": timer}, None


# The real one crashes in C++ here.
CRASHES = (("ActionClient", "action_type"), ("ActionServer", "action_type"))
# The real one accepts a message in place of its class until the first message arrives.
INSTANCES = ("msg_type", "message_type")
# Since 7.1.8, which is newer than the wheels, this may be None.
OPTIONAL = (("ActionServer", "execute_callback"),)
# Arguments that these take as "no limit", or as a time too long for a test.
WAITING = ("timeout_sec", "timeout")
LIMITLESS = (None, -1, 1.5, True)


def main() -> None:
    """Each call with one wrong value at a time."""
    rclpy.init(args=[])
    node = rclpy.create_node("wrong", allow_undeclared_parameters=True)
    for function, fitting, undo in calls(node):
        name = function.__name__
        with quiet():
            lines = []
            for parameter in fitting:
                if (name, parameter) in CRASHES:
                    continue
                found = []
                for value in wrong_values():
                    if parameter in WAITING and any(value is each for each in LIMITLESS):
                        continue
                    if value is None and (name, parameter) in OPTIONAL:
                        continue
                    if parameter in INSTANCES and isinstance(value, String):
                        continue
                    found.append(
                        f"{name_of(value)[:20]}:{outcome(lambda: function(**{**fitting, parameter: value}), undo)}"
                    )
                lines.append(f"{name} {parameter}: {' '.join(found)}")
        print("\n".join(lines), flush=True)
    rclpy.shutdown()

"""The graph: endpoint infos, names and types, counts, hidden names, type descriptions."""

import rclpy
from rclpy.duration import Duration
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.qos import QoSPresetProfiles, QoSProfile, qos_profile_best_available
from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.type_hash import TypeHash
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool
from transcript import attempt, until


def infos(node: Node) -> None:
    """The information about an endpoint that others see."""
    for number, profile in enumerate(
        (
            QoSPresetProfiles.SYSTEM_DEFAULT.value,
            QoSPresetProfiles.SENSOR_DATA.value,
            QoSProfile(history=2, depth=3),
            QoSProfile(
                depth=1,
                durability=1,
                deadline=Duration(seconds=2),
                lifespan=Duration(seconds=3),
                liveliness=3,
                liveliness_lease_duration=Duration(seconds=4),
            ),
            qos_profile_best_available,
        )
    ):
        topic = f"info{number}"
        node.create_publisher(String, topic, profile)
        until(lambda topic=topic: node.get_publishers_info_by_topic(topic))
        node.create_subscription(String, topic, print, profile)
        until(lambda topic=topic: node.get_subscriptions_info_by_topic(topic))
        for info in node.get_publishers_info_by_topic(topic) + node.get_subscriptions_info_by_topic(topic):
            print("\n".join(line for line in str(info).splitlines() if not line.startswith("GID")))
            print(len(info.endpoint_gid), type(info.endpoint_gid), info.topic_type_hash)
            print(info.qos_profile)
    node.create_subscription(String, "best_of_two", print, QoSProfile(depth=1, reliability=2))
    node.create_publisher(String, "best_of_two", QoSProfile(depth=1, durability=1, reliability=2))
    until(lambda: node.count_publishers("best_of_two") == 1)
    node.create_subscription(String, "best_of_two", print, qos_profile_best_available)
    until(lambda: node.count_subscribers("best_of_two") == 2)
    for info in node.get_subscriptions_info_by_topic("best_of_two"):
        print(info.qos_profile)
    bare = QoSProfile(depth=1, avoid_ros_namespace_conventions=True)
    plain = node.create_publisher(String, "bare", 1)
    node.create_subscription(String, "bare", print, bare)
    node.create_subscription(String, "bare", print, 1)
    until(lambda: plain.get_subscription_count() == 1)
    print("named without a prefix:", until(lambda: plain.get_subscription_count() == 2, seconds=0.2))
    print(node.get_publishers_info_by_topic("nobody"))
    attempt("bad", lambda: node.get_publishers_info_by_topic("a b"))


def names(node: Node, other: Node) -> None:
    """Names and types, mangled and not, by node and overall."""
    for topic, cls in (("chatter", String), ("_hidden", Int32), ("/abs/x", String)):
        other.create_publisher(cls, topic, 1)
        node.create_subscription(cls, topic, print, 1)
    other.create_service(SetBool, "set", print)
    node.create_client(SetBool, "/ns/set")
    node.create_client(SetBool, "nobody/serves")
    until(lambda: node.count_publishers("/abs/x") == 1 and node.count_services("/ns/set") == 1)
    until(lambda: len(rcl.rclpy_get_publisher_names_and_types_by_node(node.handle, False, "m", "/ns")) == 5)
    for no_demangle in (False, True):
        for query in (
            rcl.rclpy_get_publisher_names_and_types_by_node,
            rcl.rclpy_get_subscriber_names_and_types_by_node,
        ):
            for name, namespace in (("n", "/"), ("m", "/ns"), ("zz", "/")):
                found = attempt(
                    f"{query.__name__} {no_demangle} {name}",
                    lambda q=query, d=no_demangle, n=name, s=namespace: q(node.handle, d, n, s),
                    lambda found: len(found) > 0,
                )
                for row in found or []:
                    print("  ", row)
    for query in (
        rcl.rclpy_get_service_names_and_types_by_node,
        rcl.rclpy_get_client_names_and_types_by_node,
    ):
        for name, namespace in (("n", "/"), ("m", "/ns"), ("zz", "/")):
            attempt(f"{query.__name__} {name}", lambda q=query, n=name, s=namespace: q(node.handle, n, s))
    print(rcl.rclpy_get_topic_names_and_types(node.handle, False))
    print(
        [row for row in rcl.rclpy_get_topic_names_and_types(node.handle, True) if "discovery" not in row[0]]
    )
    print(rcl.rclpy_get_service_names_and_types(node.handle))
    for topic in ("rq/ns/setRequest", "rr/ns/setReply", "rt/abs/x", "/ns/set"):
        for query in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic):
            print(topic, query.__name__)
            for info in query(topic, no_mangle=True):
                print(info.node_name, info.topic_type, info.topic_type_hash, info.qos_profile)
    for count, names in (
        (node.count_publishers, ("chatter", "/ns/chatter", "/abs/x", "nobody", "a b")),
        (node.count_subscribers, ("chatter", "/ns/chatter", "/abs/x", "nobody", "a b")),
        (node.count_clients, ("set", "/ns/set", "nobody/serves", "a b")),
        (node.count_services, ("set", "/ns/set", "nobody/serves", "a b")),
        (node.handle.get_count_publishers, ("chatter", "/abs/x")),
    ):
        for name in names:
            attempt(f"{count.__name__} {name}", lambda count=count, name=name: count(name))
    print(sorted(node.get_node_names_and_namespaces_with_enclaves()))


def values() -> None:
    """The plain classes."""
    for name in ("/a", "/_a", "/a/_b", "a_", "_", "", "/a/b_c"):
        print(name, topic_or_service_is_hidden(name))
    print(TypeHash(), TypeHash(1, bytes(range(32))), TypeHash(1, b"x"), TypeHash(0), TypeHash() == TypeHash())
    attempt("version", lambda: TypeHash("1"))
    attempt("value", lambda: TypeHash(1, "x"))
    attempt("hash", lambda: hash(TypeHash()))
    print(TopicEndpointInfo())
    info = TopicEndpointInfo(
        node_name="n", endpoint_type=2, endpoint_gid=[1, 255], topic_type_hash={"version": 1}
    )
    print(info, info == TopicEndpointInfo(), info.endpoint_type is TopicEndpointTypeEnum.SUBSCRIPTION)
    for arguments in ({"node_name": 1}, {"nope": 1}, {"endpoint_type": "x"}, {"endpoint_type": 7}):
        attempt(f"info {arguments}", lambda arguments=arguments: TopicEndpointInfo(**arguments), str)
    attempt("qos", lambda: TopicEndpointInfo(qos_profile=3))
    attempt("qos", lambda: TopicEndpointInfo(qos_profile={"depth": 3}).qos_profile, str)
    attempt("gid", lambda: TopicEndpointInfo(endpoint_gid=["a"]))
    attempt("hash", lambda: TopicEndpointInfo(topic_type_hash=3))


def main() -> None:
    """Run every part."""
    rclpy.init()
    node = rclpy.create_node("n", start_parameter_services=False)
    other = rclpy.create_node("m", namespace="ns")
    values()
    infos(node)
    names(node, other)
    rclpy.shutdown()

"""The graph as another process sees it, while nodes and endpoints come and go, until their process ends."""

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from stage import Stage
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool
from test_msgs.msg import Empty

SPECIAL = QoSProfile(
    depth=7,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
    deadline=Duration(seconds=0.1),
    lifespan=Duration(seconds=2.5),
    liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
    liveliness_lease_duration=Duration(seconds=30),
)


def builder(stage: Stage) -> None:
    """Makes nodes and endpoints, and destroys them."""
    node = stage.node("builder", namespace="/deep/space")
    twin = stage.node("twin", start_parameter_services=False, enable_rosout=False)
    ends = [
        node.create_publisher(Float64, "value", SPECIAL),
        node.create_publisher(String, "/word", 10),
        twin.create_publisher(String, "/word", 1),
        twin.create_subscription(Empty, "~/private", print, SPECIAL),
    ]
    service = node.create_service(SetBool, "switch", print)
    twin.create_client(SetBool, "/deep/space/switch")
    stage.meet()
    stage.meet()  # it has been looked at
    node.destroy_publisher(ends[0])
    node.destroy_service(service)
    stage.meet()
    stage.meet()
    stage.executor.remove_node(twin)
    twin.destroy_node()
    stage.meet()
    stage.meet()


def watcher(stage: Stage) -> None:
    """Looks."""
    node = stage.node("watcher", start_parameter_services=False, enable_rosout=False)
    stage.meet()
    stage.until(lambda: set(node.get_node_names()) == {"builder", "twin", "watcher"}, "all nodes")
    stage.until(lambda: node.count_publishers("/word") == 2, "two publishers")
    stage.until(
        lambda: node.count_subscribers("/twin/private") and node.count_publishers("/deep/space/value")
    )
    stage.until(
        lambda: node.count_services("/deep/space/switch") and node.count_clients("/deep/space/switch")
    )
    stage.spin(0.5)

    def look():
        stage.say(sorted(node.get_node_names_and_namespaces()))
        stage.say(sorted(node.get_fully_qualified_node_names()))
        for name, types in sorted(node.get_topic_names_and_types()):
            stage.say(name, types, node.count_publishers(name), node.count_subscribers(name))
        for name, types in sorted(node.get_service_names_and_types()):
            if name.startswith("/twin"):
                continue  # upstream's node keeps its service for types when it is destroyed
            stage.say(name, types, node.count_services(name), node.count_clients(name))

    def look_closely():
        for name, namespace in sorted(node.get_node_names_and_namespaces()):
            stage.say(name, namespace)
            for kind in ("publisher", "subscriber", "service", "client"):
                ask = getattr(node, f"get_{kind}_names_and_types_by_node")
                stage.say("  ", kind, sorted(ask(name, namespace)))

    def look_at(infos):
        for info in sorted(infos, key=lambda each: each.node_name):
            profile = info.qos_profile
            stage.say(info.node_name, info.node_namespace, info.topic_type, info.endpoint_type.name)
            stage.say("  ", len(info.endpoint_gid), info.topic_type_hash, profile.reliability.name)
            stage.say(
                "  ", profile.durability.name, profile.liveliness.name, profile.deadline, profile.lifespan
            )
            stage.say("  ", profile.liveliness_lease_duration, profile.history.name, profile.depth)

    look()
    look_closely()
    for topic in ("/deep/space/value", "/word", "/twin/private", "/nothing"):
        stage.say("infos of", topic)
        look_at(node.get_publishers_info_by_topic(topic))
        look_at(node.get_subscriptions_info_by_topic(topic))
    stage.meet()
    stage.meet()
    stage.until(lambda: not node.count_publishers("/deep/space/value"))
    stage.until(lambda: not node.count_services("/deep/space/switch"))
    look()
    stage.meet()
    stage.meet()
    stage.until(lambda: "twin" not in node.get_node_names())
    stage.until(lambda: not node.count_clients("/deep/space/switch"))
    look()
    stage.meet()
    stage.until(lambda: node.get_node_names() == ["watcher"])
    stage.until(lambda: not node.count_publishers("/word"))
    stage.spin(0.2)
    look()
    stage.say(node.get_publishers_info_by_topic("/word"))


ROLES = {
    "builder": builder,
    "watcher": watcher,
}

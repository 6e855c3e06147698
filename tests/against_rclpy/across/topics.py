"""Messages from one process to another, with the metadata and the counts on both sides."""

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from stage import Stage
from std_msgs.msg import Float64, String

DURABLE = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
KINDS = {"reliable": 10, "best_effort": BEST_EFFORT, "durable": DURABLE}
VALUES = (0.1, -2.5, float("inf"))  # as many as the smallest queue holds


def talker(stage: Stage) -> None:
    """Publishes, before and after the other one is there."""
    node = stage.node("talker", namespace="/here")
    publishers = {name: node.create_publisher(Float64, name, qos) for name, qos in KINDS.items()}
    for number in range(5):
        for publisher in publishers.values():
            publisher.publish(Float64(data=number + 0.1))
    stage.meet()
    for name, publisher in publishers.items():
        stage.until(
            lambda publisher=publisher, count=1 + (name == "reliable"): (
                publisher.get_subscription_count() == count
            )
        )
        stage.say(name, publisher.get_subscription_count())
    stage.meet()
    for value in VALUES:
        for publisher in publishers.values():
            publisher.publish(Float64(data=value))
    stage.say([publisher.wait_for_all_acked(Duration(seconds=20)) for publisher in publishers.values()])
    stage.meet()
    raw = node.create_publisher(String, "raw", 10)
    stage.until(raw.get_subscription_count)
    stage.meet()
    raw.publish(serialize_message(String(data="as bytes")))
    raw.publish(String(data=""))
    stage.meet()
    stage.meet()  # the other one destroys its subscriptions
    for name, publisher in publishers.items():
        stage.until(lambda publisher=publisher: not publisher.get_subscription_count())
        stage.say(name, publisher.get_subscription_count())


def listener(stage: Stage) -> None:
    """Hears."""
    stage.meet()
    node = stage.node("listener")
    heard = {name: [] for name in (*KINDS, "raw", "late")}
    infos = []

    def hear(name):
        return lambda message: heard[name].append(message.data)

    subscriptions = [
        node.create_subscription(Float64, f"/here/{name}", hear(name), qos) for name, qos in KINDS.items()
    ]
    subscriptions.append(
        node.create_subscription(Float64, "/here/reliable", lambda _, info: infos.append(info), 10)
    )
    for each in subscriptions:
        stage.until(each.get_publisher_count)
        stage.say(each.topic_name, each.get_publisher_count())
    stage.until(lambda: len(heard["durable"]) == 3)
    stage.say("kept", heard["durable"])
    stage.meet()
    stage.until(lambda: all(len(heard[name]) >= len(VALUES) for name in KINDS) and len(infos) == len(VALUES))
    stage.until(lambda: len(heard["durable"]) == 3 + len(VALUES))
    stage.say(heard)
    for info in infos:
        stage.say(sorted(info), info["publication_sequence_number"], info["reception_sequence_number"])
        stage.say(info["source_timestamp"] <= info["received_timestamp"])
    late = node.create_subscription(Float64, "/here/durable", hear("late"), DURABLE)
    stage.until(lambda: len(heard["late"]) == 3)
    stage.say("late", heard["late"])
    stage.meet()
    node.create_subscription(String, "/here/raw", lambda data: heard["raw"].append(bytes(data)), 10, raw=True)
    stage.meet()
    stage.until(lambda: len(heard["raw"]) == 2)
    stage.say([deserialize_message(data, String).data for data in heard["raw"]])  # DDS pads bytes with zeros
    stage.meet()
    for each in (*subscriptions, late):
        node.destroy_subscription(each)
    stage.meet()


ROLES = {
    "talker": talker,
    "listener": listener,
}

"""QoS events between processes: matches, compatibility by each policy, deadlines, liveliness."""

from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import QoSProfile, qos_profile_best_available
from stage import Stage
from std_msgs.msg import String

SHORT, LONG = Duration(seconds=1), Duration(seconds=5)
PAIRS = (  # offered, requested
    ({"reliability": 2}, {"reliability": 1}),
    ({"durability": 2}, {"durability": 1}),
    ({"deadline": LONG}, {"deadline": SHORT}),
    ({}, {"deadline": SHORT}),
    ({"liveliness": 1}, {"liveliness": 3}),
    ({"liveliness_lease_duration": LONG}, {"liveliness_lease_duration": SHORT}),
    ({"durability": 2, "deadline": LONG}, {"durability": 1, "deadline": SHORT}),
    ({"reliability": 2, "durability": 2, "liveliness": 1}, {"durability": 1, "liveliness": 3}),
)
DEADLINE = QoSProfile(depth=5, deadline=Duration(seconds=1))
MANUAL = QoSProfile(depth=5, liveliness=3, liveliness_lease_duration=Duration(seconds=1.5))
AUTOMATIC = QoSProfile(depth=5, liveliness=1, liveliness_lease_duration=Duration(seconds=1.5))


def _numbers(status):
    if hasattr(status, "last_policy_kind"):
        return str(status.last_policy_kind)  # between processes, DDS counts some pairs twice
    return {name: str(getattr(status, name)) for name in sorted(dir(status)) if not name.startswith("_")}


def _of_publisher(events):
    names = ("deadline", "incompatible_qos", "liveliness", "matched")
    return PublisherEventCallbacks(
        **{name: lambda status, name=name: events.append((name, _numbers(status))) for name in names}
    )


def _of_subscription(events):
    names = ("deadline", "incompatible_qos", "liveliness", "message_lost", "matched")
    return SubscriptionEventCallbacks(
        **{name: lambda status, name=name: events.append((name, _numbers(status))) for name in names}
    )


def _show(stage, title, events):
    stage.say(title)
    for event in sorted(events, key=str):
        stage.say("  ", *event)
    events.clear()


def offering(stage: Stage) -> None:
    """Publishes."""
    node = stage.node("offering")
    events = []
    for number, (offered, _) in enumerate(PAIRS):
        publisher = node.create_publisher(
            String, f"pair{number}", QoSProfile(depth=1, **offered), event_callbacks=_of_publisher(events)
        )
        stage.until(lambda: events)
        stage.spin(0.05)
        _show(stage, f"{number} {publisher.get_subscription_count()}", events)
    stage.meet()

    publisher = node.create_publisher(String, "deadline", DEADLINE, event_callbacks=_of_publisher(events))
    stage.until(lambda: events)
    stage.meet()
    events.clear()
    stage.spin(1.5)
    _show(stage, "before the first message", events)
    publisher.publish(String(data="x"))
    stage.spin(2.5)
    _show(stage, "after one message and two periods and a half", events)
    node.destroy_publisher(publisher)
    stage.meet()

    publisher = node.create_publisher(String, "manual", MANUAL, event_callbacks=_of_publisher(events))
    stage.until(lambda: events)
    stage.meet()
    events.clear()
    publisher.assert_liveliness()
    stage.spin(0.3)
    publisher.publish(String(data="x"))
    stage.spin(0.3)
    _show(stage, "asserted, and published", events)
    stage.spin(2.0)
    _show(stage, "silent", events)
    publisher.assert_liveliness()
    stage.spin(0.2)
    _show(stage, "asserted again", events)
    node.destroy_publisher(publisher)
    stage.meet()

    publisher = node.create_publisher(String, "automatic", AUTOMATIC, event_callbacks=_of_publisher(events))
    stage.until(lambda: events)
    stage.meet()
    stage.spin(2.5)
    _show(stage, "automatic, silent for long", events)
    node.destroy_publisher(publisher)
    stage.meet()

    node.create_publisher(String, "available", QoSProfile(depth=5, reliability=2))
    stage.meet()
    publisher = node.create_publisher(String, "available_too", qos_profile_best_available)
    stage.until(publisher.get_subscription_count)
    (info,) = node.get_publishers_info_by_topic("available_too")
    stage.say(info.qos_profile.reliability.name, info.qos_profile.durability.name)
    stage.meet()


def requesting(stage: Stage) -> None:
    """Subscribes."""
    node = stage.node("requesting")
    heard, events = [], []

    def subscribe(topic, profile):
        return node.create_subscription(
            String, topic, heard.append, profile, event_callbacks=_of_subscription(events)
        )

    for number, (_, requested) in enumerate(PAIRS):
        subscription = subscribe(f"pair{number}", QoSProfile(depth=1, **requested))
        stage.until(lambda: events)
        stage.spin(0.05)
        _show(stage, f"{number} {subscription.get_publisher_count()}", events)
    stage.meet()

    subscription = subscribe("deadline", DEADLINE)
    stage.until(lambda: events)
    stage.meet()
    events.clear()
    stage.until(lambda: heard)
    stage.spin(2.4)
    _show(stage, "after one message and two periods", events)
    stage.meet()
    node.destroy_subscription(subscription)
    events.clear()

    subscription = subscribe("manual", MANUAL)
    stage.until(lambda: events)
    stage.meet()
    stage.until(lambda: len(events) >= 2)
    stage.spin(0.3)
    _show(stage, "asserted, and published", events)
    stage.until(lambda: len(events) >= 2)
    _show(stage, "silent, and asserted again", events)
    stage.meet()
    stage.until(lambda: len(events) >= 2)
    _show(stage, "gone", events)
    node.destroy_subscription(subscription)

    subscription = subscribe("automatic", AUTOMATIC)
    stage.until(lambda: len(events) == 2)
    stage.meet()
    stage.spin(2.0)
    _show(stage, "automatic, silent for long", events)
    stage.meet()
    stage.until(lambda: len(events) == 2)
    _show(stage, "gone", events)

    stage.meet()
    stage.until(lambda: node.count_publishers("available"))
    subscription = node.create_subscription(String, "available", heard.append, qos_profile_best_available)
    (info,) = node.get_subscriptions_info_by_topic("available")
    stage.say(info.qos_profile.reliability.name, info.qos_profile.durability.name)
    node.create_subscription(String, "available_too", heard.append, 10)
    stage.meet()


ROLES = {
    "offering": offering,
    "requesting": requesting,
}

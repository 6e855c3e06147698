"""QoS events: matched, incompatible QoS, deadline, liveliness, message lost."""

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String
from transcript import spin_for, until


def milliseconds(count: int) -> Duration:
    """Make a duration."""
    return Duration(nanoseconds=count * 1_000_000)


def numbers(status: object) -> dict[str, object]:
    """Show a status struct."""
    return {name: str(getattr(status, name)) for name in sorted(dir(status)) if not name.startswith("_")}


def subscription_events(events: list[object]) -> SubscriptionEventCallbacks:
    """Record every event of a subscription."""
    names = ("deadline", "incompatible_qos", "liveliness", "message_lost", "incompatible_type", "matched")
    return SubscriptionEventCallbacks(
        **{name: lambda status, name=name: events.append(("sub", name, numbers(status))) for name in names}
    )


def publisher_events(events: list[object]) -> PublisherEventCallbacks:
    """Record every event of a publisher."""
    names = ("deadline", "incompatible_qos", "liveliness", "incompatible_type", "matched")
    return PublisherEventCallbacks(
        **{name: lambda status, name=name: events.append(("pub", name, numbers(status))) for name in names}
    )


def show(title: str, events: list[object]) -> None:
    """Print events, in an order that does not depend on who receives them first."""
    print(title)
    for event in sorted(events, key=str):
        print("  ", event)
    events.clear()


def matched(node: Node, executor: SingleThreadedExecutor) -> None:
    """Let counterparts appear and disappear."""
    events: list[object] = []
    publisher = node.create_publisher(String, "m", 5, event_callbacks=publisher_events(events))
    first = node.create_subscription(String, "m", print, 5, event_callbacks=subscription_events(events))
    until(lambda: len(events) == 2, executor)
    show("first", events)
    second = node.create_subscription(String, "m", print, 5)
    until(lambda: len(events) == 1, executor)
    show("second", events)
    node.destroy_subscription(second)
    until(lambda: len(events) == 1, executor)
    show("second gone", events)
    node.destroy_publisher(publisher)
    until(lambda: len(events) == 1, executor)
    show("publisher gone", events)
    print(first.get_publisher_count())


def incompatible(node: Node, executor: SingleThreadedExecutor) -> None:
    """Each policy that makes two endpoints incompatible, and several at once."""
    events: list[object] = []
    short, long = milliseconds(1000), milliseconds(5000)
    for number, (offered, requested) in enumerate(
        (
            ({"reliability": 2}, {"reliability": 1}),
            ({"durability": 2}, {"durability": 1}),
            ({"deadline": long}, {"deadline": short}),
            ({}, {"deadline": short}),
            ({"liveliness": 1}, {"liveliness": 3}),
            ({"liveliness_lease_duration": long}, {"liveliness_lease_duration": short}),
            ({"durability": 2, "deadline": long}, {"durability": 1, "deadline": short}),
            ({"liveliness": 1, "deadline": long}, {"liveliness": 3, "deadline": short}),
            ({"reliability": 2, "durability": 2, "liveliness": 1}, {"durability": 1, "liveliness": 3}),
        )
    ):
        publisher = node.create_publisher(
            String, f"i{number}", QoSProfile(depth=1, **offered), event_callbacks=publisher_events(events)
        )
        subscription = node.create_subscription(
            String,
            f"i{number}",
            print,
            QoSProfile(depth=1, **requested),
            event_callbacks=subscription_events(events),
        )
        until(lambda: len(events) >= 2, executor)
        show(f"incompatible {sorted(offered)} {sorted(requested)}", events)
        print(publisher.get_subscription_count(), subscription.get_publisher_count())
        node.destroy_publisher(publisher)
        node.destroy_subscription(subscription)


def deadline(node: Node, executor: SingleThreadedExecutor) -> None:
    """Periods without a message, from the first one on."""
    events: list[object] = []
    profile = QoSProfile(depth=5, deadline=milliseconds(200))
    subscription = node.create_subscription(
        String, "d", lambda _: None, profile, event_callbacks=subscription_events(events)
    )
    publisher = node.create_publisher(String, "d", profile, event_callbacks=publisher_events(events))
    until(lambda: len(events) == 2, executor)
    events.clear()
    spin_for(0.5, executor)
    show("before the first message", events)
    publisher.publish(String(data="x"))
    spin_for(0.5, executor)
    show("after one message and two periods and a half", events)
    publisher.publish(String(data="y"))
    spin_for(0.1, executor)
    show("a message in time", events)
    node.destroy_publisher(publisher)
    node.destroy_subscription(subscription)


def liveliness(node: Node, executor: SingleThreadedExecutor) -> None:
    """Manual liveliness, and no events without a lease.

    Automatic liveliness is left out: within one process, Fast DDS considers such a publisher dead when it does
    not publish.
    """
    events: list[object] = []
    profile = QoSProfile(depth=5, liveliness=3, liveliness_lease_duration=milliseconds(300))
    subscription = node.create_subscription(
        String, "l", lambda _: None, profile, event_callbacks=subscription_events(events)
    )
    publisher = node.create_publisher(String, "l", profile, event_callbacks=publisher_events(events))
    spin_for(0.3, executor)
    show("matched", events)
    publisher.assert_liveliness()
    spin_for(0.15, executor)
    show("asserted", events)
    publisher.publish(String(data="x"))
    spin_for(0.15, executor)
    show("published", events)
    spin_for(0.5, executor)
    show("silent", events)
    publisher.assert_liveliness()
    spin_for(0.15, executor)
    show("asserted again", events)
    spin_for(0.4, executor)
    show("silent again", events)
    node.destroy_publisher(publisher)
    spin_for(0.3, executor)
    show("gone", events)
    node.destroy_subscription(subscription)
    subscription = node.create_subscription(
        String, "no_lease", lambda _: None, 5, event_callbacks=subscription_events(events)
    )
    publisher = node.create_publisher(String, "no_lease", 5)
    spin_for(0.3, executor)
    show("no lease", events)
    node.destroy_publisher(publisher)
    spin_for(0.3, executor)
    show("no lease: gone", events)


def patience(node: Node, executor: SingleThreadedExecutor) -> None:
    """Each subscription uses its own lease; a late one counts a publisher from its next sign of life on."""
    order: list[tuple[str, object]] = []

    def note(name: str) -> SubscriptionEventCallbacks:
        return SubscriptionEventCallbacks(liveliness=lambda status: order.append((name, numbers(status))))

    for name, kind, lease in (("impatient", 3, 400), ("patient", 1, 800)):
        profile = QoSProfile(depth=5, liveliness=kind, liveliness_lease_duration=milliseconds(lease))
        node.create_subscription(String, "p", lambda _: None, profile, event_callbacks=note(name))
    events = PublisherEventCallbacks(liveliness=lambda status: order.append(("publisher", numbers(status))))
    profile = QoSProfile(depth=5, liveliness=3, liveliness_lease_duration=milliseconds(150))
    publisher = node.create_publisher(String, "p", profile, event_callbacks=events)
    until(lambda: publisher.get_subscription_count() == 2)
    publisher.assert_liveliness()
    until(lambda: len(order) == 2, executor)
    print(sorted(order, key=str))
    order.clear()
    spin_for(1.2, executor)
    print(order)
    order.clear()
    publisher.assert_liveliness()
    profile = QoSProfile(depth=5, liveliness=3, liveliness_lease_duration=milliseconds(2000))
    node.create_subscription(String, "p", lambda _: None, profile, event_callbacks=note("late"))
    until(lambda: publisher.get_subscription_count() == 3)
    spin_for(0.05, executor)
    print([name for name, _ in order if name == "late"])
    publisher.assert_liveliness()
    until(lambda: "late" in [name for name, _ in order], executor)
    print([event for event in order if event[0] == "late"])


def overflow(node: Node, executor: SingleThreadedExecutor) -> None:
    """Messages that do not fit in the history are dropped without an event."""
    events: list[object] = []
    for reliability in (1, 2):
        heard: list[str] = []
        profile = QoSProfile(depth=5, reliability=reliability)
        publisher = node.create_publisher(String, f"o{reliability}", profile)
        subscription = node.create_subscription(
            String,
            f"o{reliability}",
            lambda message, heard=heard: heard.append(message.data),
            profile,
            event_callbacks=subscription_events(events),
        )
        until(lambda: len(events) == 1, executor)
        events.clear()
        for number in range(20):
            publisher.publish(String(data=str(number)))
        spin_for(0.3, executor)
        print(heard)
        show("overflow", events)
        node.destroy_subscription(subscription)


def handles(node: Node) -> None:
    """Events by their handles and a wait set, as custom executors use them."""
    publisher = node.create_publisher(String, "h", 5)
    subscription = node.create_subscription(String, "h2", print, 5)
    print(len(publisher.event_handlers), len(subscription.event_handlers))
    print([str(handler.event_type) for handler in publisher.event_handlers + subscription.event_handlers])
    quiet = node.create_publisher(
        String, "h3", 5, event_callbacks=PublisherEventCallbacks(use_default_callbacks=False)
    )
    print(len(quiet.event_handlers))
    for parent, types in (
        (publisher, rcl.rcl_publisher_event_type_t),
        (subscription, rcl.rcl_subscription_event_type_t),
    ):
        for name, event_type in types.__members__.items():
            wait_set = rcl.WaitSet(0, 0, 0, 0, 0, 1, node.context.handle)
            with parent.handle:
                event = rcl.EventHandle(parent.handle, event_type)
            with event:
                index = wait_set.add_event(event)
            wait_set.wait(0)
            with event:
                print(name, wait_set.is_ready("event", index), numbers(event.take_event()))


def main() -> None:
    """Run every part on one node."""
    rclpy.init()
    node = rclpy.create_node("n", start_parameter_services=False)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    matched(node, executor)
    incompatible(node, executor)
    deadline(node, executor)
    liveliness(node, executor)
    patience(node, executor)
    overflow(node, executor)
    handles(node)
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown()

"""Messages as bytes, ownership, message info, history, late joiners, lifespan, and what is refused."""

import functools
from array import array

import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool
from transcript import attempt, spin_for, until

HI = b"\x00\x01\x00\x00\x03\x00\x00\x00hi\x00"


def kind_of_error(label: str, call: object) -> None:
    """Print only the class of an error: its text names C++ libraries."""
    try:
        print(label, call())  # type: ignore[operator]
    except Exception as error:
        print(label, [cls.__name__ for cls in type(error).__mro__[:-3]])


def serialization() -> None:
    """Bytes that fit and bytes that do not."""
    attempt("serialize", lambda: serialize_message(String(data="hi")))
    attempt("serialize 3", lambda: serialize_message(3))
    attempt("deserialize", lambda: deserialize_message(HI, String))
    attempt("big endian", lambda: deserialize_message(b"\0\0\0\0\0\0\0\3hi\0", String))
    attempt("longer", lambda: deserialize_message(HI + b"more", String))
    attempt("no type", lambda: deserialize_message(HI, 3))
    for data in (b"", b"\0", HI[:-1], b"\0\1\0\0\xff\0\0\0hi\0", "text", bytearray(HI), None):
        kind_of_error(f"deserialize {data!r}", lambda data=data: deserialize_message(data, String))


def raw(node: Node, executor: SingleThreadedExecutor) -> None:
    """Raw subscriptions, published bytes, and messages taken from the handle."""
    heard: list[object] = []
    publisher = node.create_publisher(String, "raw", 10)
    node.create_subscription(String, "raw", heard.append, 10, raw=True)
    other = node.create_subscription(String, "raw", lambda m, i: heard.append((m, sorted(i))), 10)
    until(lambda: publisher.get_subscription_count() == 2)
    publisher.publish(String(data="hi"))
    publisher.publish(HI)
    until(lambda: len(heard) == 4, executor)
    print(sorted(heard, key=str))
    heard.clear()
    for data in (b"", b"xx", b"\x00\x01\x00\x00\xff\x00\x00\x00hi\x00"):
        publisher.publish(data)
    until(lambda: len(heard) == 3, executor)
    print(sorted(heard, key=str))
    executor.remove_node(node)
    print(other.handle.take_message(String, False))
    publisher.publish(String(data="taken"))
    until(lambda: heard.append(other.handle.take_message(String, False)) or heard[-1])
    message, info = heard[-1]  # type: ignore[misc]
    print(message, sorted((key, type(value).__name__) for key, value in info.items()))
    print(info["received_timestamp"] >= info["source_timestamp"])
    executor.add_node(node)


def ownership(node: Node, executor: SingleThreadedExecutor) -> None:
    """A subscriber owns its message, which is as it would arrive over the wire."""
    heard: list[JointState] = []
    publisher = node.create_publisher(JointState, "own", 10)
    node.create_subscription(JointState, "own", heard.append, 10)
    node.create_subscription(JointState, "own", heard.append, 10)
    until(lambda: publisher.get_subscription_count() == 2)
    message = JointState(name=["a", "b"], position=[1.0, 2.0])
    publisher.publish(message)
    message.name.append("c")
    message.position.append(3.0)
    until(lambda: len(heard) == 2, executor)
    heard[0].name.append("d")
    print(heard[1], heard[0] is not heard[1], type(heard[0].position) is array)


def callbacks(node: Node, executor: SingleThreadedExecutor) -> None:
    """The kinds of callables that can be callbacks."""
    heard: list[object] = []

    class Listener:
        def listen(self, message: Int32) -> None:
            heard.append(("method", message.data))

        def __call__(self, message: Int32, info: object) -> None:
            heard.append(("call", message.data, type(info).__name__))

    listener = Listener()
    publisher = node.create_publisher(Int32, "cb", 10)
    for number, callback in enumerate(
        (
            heard.append,
            listener.listen,
            listener,
            functools.partial(lambda extra, message: heard.append((extra, message.data)), "partial"),
            lambda *args: heard.append(("args", len(args))),
            lambda message, info=None: heard.append(("default", info)),
            lambda: None,
            lambda a, b, c: None,
            print,
            3,
        )
    ):
        subscription = attempt(
            f"callback {number}",
            lambda callback=callback: node.create_subscription(Int32, "cb", callback, 10),
            lambda value: value._callback_type,
        )
        if subscription is None:
            continue
        if number < 6:
            until(lambda: publisher.get_subscription_count() == 1)
            publisher.publish(Int32(data=number))
            until(lambda: len(heard) == 1, executor)
            print(heard)
        heard.clear()
        node.destroy_subscription(subscription)


def history(node: Node, executor: SingleThreadedExecutor) -> None:
    """Keep last, keep all, late joiners."""
    for keep, depth, reader_depth, durability in ((1, 3, 10, 1), (1, 10, 3, 1), (2, 0, 10, 1), (1, 0, 0, 1)):
        heard: list[int] = []
        topic = f"history_{keep}_{depth}_{reader_depth}"
        offered = QoSProfile(history=keep, depth=depth, durability=durability)
        publisher = node.create_publisher(Int32, topic, offered)
        for number in range(10):
            publisher.publish(Int32(data=number))
        requested = QoSProfile(depth=reader_depth, durability=durability)
        node.create_subscription(Int32, topic, lambda m, heard=heard: heard.append(m.data), requested)
        node.create_subscription(Int32, topic, lambda m, heard=heard: heard.append(-m.data), 10)
        until(lambda publisher=publisher: publisher.get_subscription_count() == 2)
        until(lambda: False, seconds=0.2)  # DDS replays in the background: read when everything has arrived
        spin_for(0.1, executor)
        print(topic, heard)


def lifespan(node: Node, executor: SingleThreadedExecutor) -> None:
    """The publisher's lifespan empties its history, the subscription's its queue."""
    for writer, reader in ((400, 0), (0, 400), (400, 400)):
        heard: list[str] = []
        late: list[str] = []
        topic = f"lifespan_{writer}_{reader}"
        offered, requested, plain = (
            QoSProfile(depth=5, durability=1, lifespan=Duration(nanoseconds=span * 1_000_000))
            for span in (writer, reader, 0)
        )
        publisher = node.create_publisher(String, topic, offered)
        node.create_subscription(String, topic, lambda m, heard=heard: heard.append(m.data), requested)
        until(lambda publisher=publisher: publisher.get_subscription_count() == 1)
        publisher.publish(String(data="old"))
        until(lambda: False, seconds=0.7)
        publisher.publish(String(data="new"))
        spin_for(0.02, executor)
        node.create_subscription(String, topic, lambda m, late=late: late.append(m.data), plain)
        spin_for(0.2, executor)
        print(topic, heard, "late:", late)


def refused(node: Node) -> None:
    """Wrong types, names and uses after destruction."""
    publisher = node.create_publisher(String, "refused", 10)
    subscription = node.create_subscription(String, "refused", print, 10)
    for message in (3, "text", Int32(), None, String, bytearray(HI)):
        attempt(f"publish {type(message).__name__}", lambda message=message: publisher.publish(message))
    for cls in (int, 3, None, SetBool, SetBool.Request):
        attempt(f"publisher of {cls}", lambda cls=cls: type(node.create_publisher(cls, "x1", 1)).__name__)
        attempt(
            f"subscription to {cls}",
            lambda cls=cls: type(node.create_subscription(cls, "x1", print, 1)).__name__,
        )
    for cls in (int, String, SetBool.Request):
        attempt(f"service of {cls}", lambda cls=cls: node.create_service(cls, "x2", print))
        attempt(f"client of {cls}", lambda cls=cls: node.create_client(cls, "x2"))
    profile = QoSProfile(depth=1).get_c_qos_profile()
    for make in (rcl.Publisher, rcl.Subscription):
        for name in ("a b", "/a//b", "", "1a"):
            attempt(f"{make.__name__} {name!r}", lambda m=make, n=name: m(node.handle, String, n, profile))
    for depth in (-1, "x", None, 1.5):
        attempt(f"depth {depth!r}", lambda depth=depth: node.create_publisher(String, "x3", depth))
        attempt(f"depth {depth!r}", lambda depth=depth: node.create_subscription(String, "x3", print, depth))
    print(publisher.topic_name, subscription.topic_name, publisher.logger_name, subscription.logger_name)
    print(publisher.topic, publisher.msg_type, subscription.raw, publisher.wait_for_all_acked())
    print(publisher.wait_for_all_acked(Duration(seconds=1)), type(publisher.handle.pointer).__name__)
    node.destroy_publisher(publisher)
    node.destroy_subscription(subscription)
    for label, use in (
        ("publish", lambda: publisher.publish(String())),
        ("publish wrong", lambda: publisher.publish(3)),
        ("count", publisher.get_subscription_count),
        ("name", lambda: publisher.topic_name),
        ("assert", publisher.assert_liveliness),
        ("acked", publisher.wait_for_all_acked),
        ("logger", lambda: publisher.logger_name),
        ("subscription count", subscription.get_publisher_count),
        ("subscription name", lambda: subscription.topic_name),
        ("destroy again", lambda: node.destroy_publisher(publisher)),
        ("destroy foreign", lambda: node.destroy_publisher(3)),
        ("handle", lambda: publisher.handle.publish(String())),
        ("enter", publisher.handle.__enter__),
    ):
        attempt(f"destroyed: {label}", use)


def types_on_a_topic(node: Node) -> None:
    """A name has one type in a context, as long as somebody uses it."""
    publisher = node.create_publisher(String, "typed", 1)
    kind_of_error("publisher", lambda: node.create_publisher(Int32, "typed", 1))
    kind_of_error("subscription", lambda: node.create_subscription(Int32, "typed", print, 1))
    node.destroy_publisher(publisher)
    print(type(node.create_publisher(Int32, "typed", 1)).__name__)


def main() -> None:
    """Run every part on one node."""
    rclpy.init()
    node = rclpy.create_node("n", namespace="/s", start_parameter_services=False)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    serialization()
    raw(node, executor)
    ownership(node, executor)
    callbacks(node, executor)
    history(node, executor)
    lifespan(node, executor)
    refused(node)
    types_on_a_topic(node)
    last = node.create_publisher(String, "last", 1)
    rclpy.shutdown()
    attempt("after shutdown", lambda: last.publish(String()))
    attempt("create after shutdown", lambda: node.create_publisher(String, "more", 1))
    attempt("subscribe after shutdown", lambda: node.create_subscription(String, "more", print, 1))
    attempt("serve after shutdown", lambda: node.create_service(SetBool, "more", print))

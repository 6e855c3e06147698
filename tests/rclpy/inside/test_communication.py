"""Guarantees of the local middleware that a comparison with the real one cannot show."""

from __future__ import annotations

import gc
import hashlib
import importlib
import json
import random
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import Point, Pose
from ifgen_pytest.domains import RANGE
from ifgen_runtime.type_description import describe
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from rmw_local import observer, timing
from rmw_local.message import message_type
from rmw_local.notices import Drops
from sensor_msgs.msg import JointState
from std_msgs.msg import Float32, Int8, String
from std_srvs.srv import SetBool
from test_msgs.msg import Arrays
from test_msgs.srv import BasicTypes


@pytest.fixture(autouse=True)
def _rclpy_is_up() -> Iterator[None]:
    gc.collect()  # objects that earlier tests left in reference cycles would still be in the graph
    rclpy.init()
    yield
    rclpy.try_shutdown()


class ManualTime:
    """Time that only tests advance; nobody waits."""

    def __init__(self) -> None:
        self.now = 10**18
        self.waker = timing.SYSTEM.waker

    def time_ns(self) -> int:
        """The system time."""
        return self.now

    def monotonic_ns(self) -> int:
        """The steady time."""
        return self.now

    def wait(self, waker: timing.Waker, until: int | None) -> bool:
        """Advance to the time at once."""
        self.now = max(self.now, until or 0)
        return waker.sleep(0)


@pytest.fixture
def clock() -> Iterator[ManualTime]:
    """Install a time that only the test advances."""
    manual = ManualTime()
    before = timing.install(manual)
    yield manual
    timing.install(before)


def profile(**policies: Any) -> Any:
    """Make a profile for handles; durations in ms."""
    from rclpy.duration import Duration

    durations = {"deadline", "lifespan", "liveliness_lease_duration"}
    given = {
        name: Duration(nanoseconds=value * 10**6) if name in durations else value
        for name, value in policies.items()
    }
    return QoSProfile(**{"depth": 10, **given}).get_c_qos_profile()


def taken(subscription: Any) -> list[Any]:
    """Take all messages of a subscription's handle."""
    messages = []
    while (pair := subscription.take_message(None, False)) is not None:
        messages.append(pair[0])
    return messages


# Delivery


def test_delivery_equals_a_round_trip_over_the_wire() -> None:
    """Floats are rounded, lists become arrays, and the subscriber owns everything."""
    node = Node("n")
    publisher = rcl.Publisher(node.handle, Float32, "f", profile())
    subscription = rcl.Subscription(node.handle, Float32, "f", profile())
    publisher.publish(Float32(data=0.1))
    assert taken(subscription) == [deserialize_message(serialize_message(Float32(data=0.1)), Float32)]
    publisher = rcl.Publisher(node.handle, JointState, "j", profile())
    first, second = (rcl.Subscription(node.handle, JointState, "j", profile()) for _ in range(2))
    message = JointState(name=["a"], position=[1.0])
    publisher.publish(message)
    message.name.append("b")
    message.header.frame_id = "changed"
    (one,), (two,) = taken(first), taken(second)
    assert one == two == JointState(name=["a"], position=[1.0])
    assert one is not two
    assert one.header is not two.header


@pytest.mark.parametrize("subscribed", [True, False])
@pytest.mark.parametrize(
    ("message", "where"),
    [
        (String(data=3), "String.data"),  # type: ignore[arg-type]
        (Int8(data=1000), "Int8.data"),
        (JointState(name=["a", None]), "JointState.name[1]"),  # type: ignore[list-item]
    ],
)
def test_wrong_field_values_are_refused_at_publish(message: Any, where: str, subscribed: bool) -> None:
    """The error names the field, whether or not anybody listens, and nothing is delivered."""
    node = Node("n")
    publisher = node.create_publisher(type(message), "t", 10)
    subscription = rcl.Subscription(node.handle, type(message), "t", profile()) if subscribed else None
    with pytest.raises(ValueError, match=where.replace("[", r"\[")):
        publisher.publish(message)
    assert subscription is None or taken(subscription) == []


def test_half_a_surrogate_pair_raises_what_rclpy_raises() -> None:
    """A UnicodeEncodeError that names the field; also for services and serialize_message."""
    node = Node("n")
    publisher = node.create_publisher(String, "t", 10)
    client = rcl.Client(node.handle, BasicTypes, "s", profile())
    for send in (
        lambda: publisher.publish(String(data="bad \ud83d")),
        lambda: serialize_message(String(data="bad \ud83d")),
        lambda: client.send_request(BasicTypes.Request(string_value="bad \ud83d")),
    ):
        with pytest.raises(UnicodeEncodeError, match=r"\.(data|string_value): half of a surrogate pair"):
            send()


def test_a_wrong_response_is_refused_by_the_service() -> None:
    """Services check values as publishers do."""
    node = Node("n")
    client = rcl.Client(node.handle, SetBool, "s", profile())
    service = rcl.Service(node.handle, SetBool, "s", profile())
    with pytest.raises(ValueError, match=r"SetBool_Request\.data"):
        client.send_request(SetBool.Request(data="yes"))  # type: ignore[arg-type]
    client.send_request(SetBool.Request(data=True))
    _, header = service.service_take_request(SetBool.Request)
    with pytest.raises(ValueError, match=r"SetBool_Response\.message"):
        service.service_send_response(SetBool.Response(message=b"x"), header.request_id)  # type: ignore[arg-type]


def test_contexts_share_a_domain_and_nothing_crosses_domains(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two contexts of one domain communicate; another domain receives and sees nothing."""
    monkeypatch.setenv(RANGE, "OFF")  # other processes may use these domains
    contexts = [Context() for _ in range(3)]
    for context, domain in zip(contexts, (7, 7, 8), strict=True):
        context.init(domain_id=domain)
    nodes = [Node(f"n{number}", context=context) for number, context in enumerate(contexts)]
    publisher = rcl.Publisher(nodes[0].handle, String, "t", profile())
    near, far = (rcl.Subscription(node.handle, String, "t", profile()) for node in nodes[1:])
    publisher.publish(String(data="hi"))
    assert [message.data for message in taken(near)] == ["hi"]
    assert taken(far) == []
    assert nodes[1].get_node_names() == ["n0", "n1"]
    assert nodes[2].get_node_names() == ["n2"]
    for context in contexts:
        context.shutdown()


def test_what_is_collected_leaves_the_graph() -> None:
    """An endpoint whose handle nobody holds is gone from the graph."""
    node = Node("n")
    publisher = rcl.Publisher(node.handle, String, "t", profile())
    handles = [
        rcl.Subscription(node.handle, String, "t", profile()),
        rcl.Publisher(node.handle, String, "t", profile()),
        rcl.Client(node.handle, SetBool, "s", profile()),
        rcl.Service(node.handle, SetBool, "s", profile()),
    ]
    assert node.count_subscribers("t") == node.count_services("s") == node.count_clients("s") == 1
    handles.clear()
    gc.collect()
    assert publisher.get_subscription_count() == 0
    assert node.count_subscribers("t") == node.count_services("s") == node.count_clients("s") == 0
    assert node.count_publishers("t") == 1


# Timed events, with time under control


def event(handle: Any, kind: Any) -> Any:
    """Make the handle of an event."""
    return rcl.EventHandle(handle, kind)


def test_deadlines_are_counted_per_period(clock: ManualTime) -> None:
    """After the first message, each period without one counts once, on both sides."""
    node = Node("n")
    publisher = rcl.Publisher(node.handle, String, "d", profile(deadline=100))
    subscription = rcl.Subscription(node.handle, String, "d", profile(deadline=100))
    events = [
        event(publisher, rcl.rcl_publisher_event_type_t.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED),
        event(subscription, rcl.rcl_subscription_event_type_t.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED),
    ]
    clock.now += 10**9
    assert [each.is_ready() for each in events] == [False, False]
    assert events[0].wake_at() is None
    woken: list[int] = []
    events[0].add_listener(lambda: woken.append(1))
    publisher.publish(String())
    assert woken == [1]
    assert [each.wake_at() for each in events] == [clock.now + 100 * 10**6] * 2
    clock.now += 99 * 10**6
    assert not any(each.is_ready() for each in events)
    clock.now += 251 * 10**6
    for each in events:
        assert each.is_ready()
        status = each.take_event()
        assert (status.total_count, status.total_count_change) == (3, 3)
        assert not each.is_ready()
    publisher.publish(String())
    clock.now += 100 * 10**6
    assert [each.take_event().total_count for each in events if each.is_ready()] == [4, 4]


def test_manual_liveliness_lapses(clock: ManualTime) -> None:
    """Alive from the first sign, not alive a lease after the last; both sides know when to check."""
    node = Node("n")
    policies = {"liveliness": 3, "liveliness_lease_duration": 100}
    publisher = rcl.Publisher(node.handle, String, "l", profile(**policies))
    subscription = rcl.Subscription(node.handle, String, "l", profile(**policies))
    lost = event(publisher, rcl.rcl_publisher_event_type_t.RCL_PUBLISHER_LIVELINESS_LOST)
    changed = event(subscription, rcl.rcl_subscription_event_type_t.RCL_SUBSCRIPTION_LIVELINESS_CHANGED)
    assert not changed.is_ready()
    publisher.assert_liveliness()
    assert changed.is_ready()
    assert lost.wake_at() == changed.wake_at() == clock.now + 100 * 10**6
    status = changed.take_event()
    assert (status.alive_count, status.alive_count_change, status.not_alive_count) == (1, 1, 0)
    clock.now += 80 * 10**6
    publisher.publish(String())
    clock.now += 80 * 10**6
    assert not lost.is_ready()
    clock.now += 20 * 10**6
    assert lost.is_ready()
    assert lost.take_event().total_count == 1
    status = changed.take_event()
    assert (status.alive_count, status.not_alive_count, status.not_alive_count_change) == (0, 1, 1)
    publisher.destroy_when_not_in_use()
    status = changed.take_event()
    assert (status.alive_count, status.not_alive_count, status.not_alive_count_change) == (0, 0, -1)


def test_lifespan_ends_at_the_subscription(clock: ManualTime) -> None:
    """A message that has waited too long is not read."""
    node = Node("n")
    publisher = rcl.Publisher(node.handle, String, "s", profile())
    subscription = rcl.Subscription(node.handle, String, "s", profile(lifespan=100))
    publisher.publish(String(data="old"))
    clock.now += 60 * 10**6
    publisher.publish(String(data="young"))
    clock.now += 50 * 10**6
    assert subscription.is_ready()
    assert [message.data for message in taken(subscription)] == ["young"]
    publisher.publish(String(data="old"))
    clock.now += 100 * 10**6
    assert not subscription.is_ready()


# Two definitions of one type


def other_definition(cls: type[Any], *changes: tuple[str, str]) -> type[Any]:
    """Generate the class again from its own module's text, changed, as another program might have it."""
    original = sys.modules[cls.__module__]
    text = Path(str(original.__file__)).read_text()
    for old, new in (("RIHS01_", "RIHS01_0"), *changes):
        assert old in text
        text = text.replace(old, new)
    module = ModuleType(cls.__module__)
    sys.modules[cls.__module__] = module
    try:
        exec(compile(text, "other", "exec"), vars(module))
    finally:
        sys.modules[cls.__module__] = original
    return getattr(module, cls.__name__)  # type: ignore[no-any-return]


def test_the_same_definition_in_two_classes_talks() -> None:
    """A module that was loaded twice is one type: each side gets objects of its own class."""
    theirs = other_definition(Point)
    theirs.__type_hash__ = Point.__type_hash__
    node = Node("n")
    publisher = rcl.Publisher(node.handle, Point, "p", profile())
    subscription = rcl.Subscription(node.handle, theirs, "p", profile())
    publisher.publish(Point(x=1.0))
    (message,) = taken(subscription)
    assert type(message) is theirs
    assert message.x == 1.0


# Looking on


class Notes:
    """An observer that records everything."""

    def __init__(self) -> None:
        self.lines: list[tuple[object, ...]] = []
        self.open: list[object] = []

    def undelivered(self, topic: str, count: int, why: str) -> None:
        """Record a message that nobody received."""
        self.lines.append(("undelivered", topic, count, why))

    def incompatible_qos(self, topic: str, policy_kind: int, writer_node: str, reader_node: str) -> None:
        """Record endpoints whose QoS does not match."""
        self.lines.append(("qos", topic, policy_kind, writer_node, reader_node))

    def opened(self, entity: object) -> None:
        """Note an entity as open."""
        self.open.append(entity)

    def closed(self, entity: object) -> None:
        """Note an entity as closed."""
        if entity in self.open:  # without entities that an earlier test has left to the garbage collector
            self.open.remove(entity)


@pytest.fixture
def notes() -> Iterator[Notes]:
    """Install an observer."""
    noting = Notes()
    before = observer.install(noting)
    yield noting
    observer.install(before)


def test_the_observer_sees_what_goes_by_silently(notes: Notes) -> None:
    """The observer reports undelivered messages, incompatible endpoints, and what is still open."""
    node = Node("n", start_parameter_services=False, enable_rosout=False)
    notes.lines.clear()
    publisher = rcl.Publisher(node.handle, String, "t", profile())
    publisher.publish(String())
    subscription = rcl.Subscription(node.handle, String, "t", profile(depth=1))
    publisher.publish(String())
    publisher.publish(String())
    subscription.destroy_when_not_in_use()
    client = rcl.Client(node.handle, SetBool, "s", profile())
    client.send_request(SetBool.Request())
    service = rcl.Service(node.handle, SetBool, "s", profile())
    client.send_request(SetBool.Request())
    _, header = service.service_take_request(SetBool.Request)
    client.destroy_when_not_in_use()
    service.service_send_response(SetBool.Response(), header.request_id)
    strict = rcl.Subscription(node.handle, String, "t", profile(durability=1))
    assert notes.lines == [
        ("undelivered", "/t", 1, "published while no subscription was matched"),
        ("undelivered", "/t", 1, "overwritten before it was read"),
        ("undelivered", "/t", 1, "never read"),
        ("undelivered", "/s", 1, "requested while no service was matched"),
        ("undelivered", "/s", 1, "answered when the client was gone"),
        ("qos", "/t", 2, "/n", "/n"),
    ]
    assert publisher.writer in notes.open
    for handle in (publisher, service, strict):
        handle.destroy_when_not_in_use()
    node.destroy_node()
    assert notes.open == []


# Type descriptions


@pytest.mark.parametrize(
    "type_name",
    [
        "std_msgs.msg.Empty",
        "geometry_msgs.msg.PoseStamped",
        "test_msgs.msg.Arrays",
        "test_msgs.msg.BoundedSequences",
        "test_msgs.msg.MultiNested",
        "test_msgs.msg.WStrings",
        "rcl_interfaces.msg.ParameterEvent",
        "std_srvs.srv.SetBool",
        "test_msgs.srv.BasicTypes",
        "test_msgs.action.Fibonacci.Impl.SendGoalService",
        "test_msgs.action.Fibonacci.Impl.FeedbackMessage",
    ],
)
def test_descriptions_give_the_type_hash(type_name: str) -> None:
    """The hash of a class's own description is the one that its generator computed."""
    package, kind, name, *parts = type_name.split(".")
    cls = getattr(importlib.import_module(f"{package}.{kind}"), name)
    for part in parts:
        cls = getattr(cls, part)

    document = describe(cls)
    for individual in (document["type_description"], *document["referenced_type_descriptions"]):
        for field in individual["fields"]:
            del field["default_value"]
    assert "RIHS01_" + hashlib.sha256(json.dumps(document).encode()).hexdigest() == cls.__type_hash__


def test_wait_for_service_returns_when_the_service_comes() -> None:
    """The graph wakes the wait: it does not poll."""
    import threading
    import time

    from rmw_local.virtual_time import virtual_time

    def serve() -> None:
        node.create_service(SetBool, "soon", lambda _, response: response)

    with virtual_time():
        node = Node("n")
        client = node.create_client(SetBool, "soon")
        timer = threading.Timer(0.05, serve)
        began = time.monotonic()
        timer.start()
        assert client.wait_for_service(timeout_sec=10.0)
        assert time.monotonic() - began == pytest.approx(0.05)
        timer.join()


def test_memory_stays_flat() -> None:
    """Messages that were read or overwritten leave nothing behind."""
    node = Node("n")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    publisher = node.create_publisher(String, "flat", 5)
    node.create_subscription(String, "flat", lambda _: None, 5)
    message = String(data="x")

    def work() -> None:
        for _ in range(300):
            publisher.publish(message)
            publisher.publish(message)
            executor.spin_once(timeout_sec=1)

    work()
    gc.collect()
    before = len(gc.get_objects())
    work()
    assert len(gc.get_objects()) - before < 50  # without garbage collection: nothing is left in cycles either


def test_a_message_of_another_class_is_refused_in_words() -> None:
    """Upstream raises a TypeError without a text."""
    node = Node("n")
    client = node.create_client(SetBool, "words")
    service = node.create_service(SetBool, "words", lambda _, response: response)
    for given, said in (
        (SetBool.Response(), "SetBool_Response"),
        (SetBool.Request, "the class SetBool_Request itself"),
        (None, "None"),
    ):
        with pytest.raises(TypeError, match=f"^expected SetBool_Request, got {said}$"):
            client.call_async(given)
    with pytest.raises(TypeError, match=r"^expected SetBool_Response, got SetBool_Request$"):
        service.send_response(SetBool.Request(), None)


def test_endpoints_that_come_and_go_leave_nothing() -> None:
    """Creating, using and destroying every kind of endpoint leaves no object."""
    node = Node("n")

    def churn() -> None:
        for _ in range(30):
            publisher = node.create_publisher(String, "churn", 10)
            subscription = node.create_subscription(String, "churn", lambda _: None, 10)
            publisher.publish(String())
            node.destroy_publisher(publisher)
            node.destroy_subscription(subscription)
            client = node.create_client(SetBool, "churn")
            service = node.create_service(SetBool, "churn", lambda _, response: response)
            client.call_async(SetBool.Request())
            node.destroy_client(client)
            node.destroy_service(service)

    churn()
    gc.collect()
    before = len(gc.get_objects())
    churn()
    gc.collect()
    assert len(gc.get_objects()) - before < 20


def test_garbled_bytes_never_leave_the_middleware() -> None:
    """For any published bytes, a typed subscription gets a message or nothing, and raises nothing."""
    rng = random.Random(5)
    node = Node("n")
    for message in (JointState(name=["a", "b"], position=[1.0]), Pose(), String(data="text"), Arrays()):
        publisher = rcl.Publisher(node.handle, type(message), "garbled", profile())
        subscription = rcl.Subscription(node.handle, type(message), "garbled", profile(depth=1000))
        good = bytearray(serialize_message(message))
        for _ in range(150):
            data = bytearray(good)
            for _ in range(rng.randrange(1, 5)):
                data[rng.randrange(len(data))] = rng.randrange(256)
            publisher.publish_raw(bytes(data[: rng.randrange(len(data) + 1)]))
        publisher.publish(message)
        heard = [pair and pair[0] for pair in (subscription.take_message(None, False) for _ in range(151))]
        assert {type(each) for each in heard} <= {type(None), type(message)}
        assert None in heard
        assert repr(heard[-1]) == repr(message)
        assert not subscription.is_ready()
        publisher.destroy_when_not_in_use()
        subscription.destroy_when_not_in_use()


def test_dropped_payloads_are_told_once_a_second_with_their_number(
    clock: ManualTime, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(message_type(String), "drops", Drops("std_msgs/msg/String"))  # none yet
    node = rclpy.create_node("n")
    subscription = node.create_subscription(String, "words", lambda _: None, 10)
    number = node.create_subscription(Float32, "number", lambda _: None, 10)
    words = node.create_publisher(String, "words", 10).handle
    for milliseconds in (0, 0, 900, 100, 1900, 100):
        clock.now += milliseconds * 10**6
        words.publish_serialized(b"\0\1\0\0\xff\xff")
        assert taken(subscription.handle) == []
    node.create_publisher(Float32, "number", 10).handle.publish_serialized(b"")
    assert taken(number.handle) == []
    told = "rmw_local: dropped {} of type {} (does a publisher have another definition of it?)"
    assert capsys.readouterr().err.splitlines() == [
        told.format("1 malformed message", "std_msgs::msg::String"),
        told.format("3 malformed messages", "std_msgs::msg::String"),
        told.format("1 malformed message", "std_msgs::msg::String"),
        told.format("1 malformed message", "std_msgs::msg::String"),
        told.format("1 malformed message", "std_msgs::msg::Float32"),
    ]


def test_an_answer_after_another_thread_has_destroyed_the_service_is_an_invalid_handle() -> None:
    node = Node("n")
    service = node.create_service(SetBool, "s", lambda _, response: response)

    class Header(rcl.rmw_service_info_t):
        @property
        def request_id(self) -> rcl.rmw_request_id_t:  # read between check and use of the handle
            node.destroy_service(service)
            return rcl.rmw_request_id_t(1, bytes(16))

    with pytest.raises(rcl.InvalidHandle):
        service.send_response(SetBool.Response(), Header(0, 0, rcl.rmw_request_id_t(1, bytes(16))))

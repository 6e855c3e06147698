"""Listeners, broadcasters, and a buffer that other nodes ask."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

import pytest
import rclpy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from tf2_msgs.action import LookupTransform
from tf2_msgs.msg import TF2Error, TFMessage
from tf2_ros import (
    Buffer,
    BufferClient,
    BufferServer,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    StaticTransformBroadcaster,
    StaticTransformListener,
    TimeoutException,
    TransformBroadcaster,
    TransformException,
    TransformListener,
)

SOON = Duration(seconds=20)
LATEST = Time()


def edge(child: str, x: float = 0.1, parent: str = "map") -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, Time(seconds=2).to_msg()
    message.transform.translation.x = x
    return message


def spin_until(executor: Any, condition: Callable[[], Any]) -> None:
    steady = rclpy.clock.Clock(clock_type=rclpy.clock.ClockType.STEADY_TIME)
    end = steady.now() + SOON
    while not condition():
        assert steady.now() < end
        executor.spin_once(timeout_sec=0.1)


def x_of(buffer: Any, child: str) -> float:
    return buffer.lookup_transform("map", child, LATEST).transform.translation.x  # type: ignore[no-any-return]


def test_transforms_reach_a_listener(ros_node: Any, ros_executor: Any) -> None:
    sender, receiver = ros_node("sender"), ros_node("receiver")
    buffer = Buffer()
    listener = TransformListener(buffer, receiver)
    broadcaster, static = TransformBroadcaster(sender), StaticTransformBroadcaster(sender)
    spin_until(ros_executor, lambda: broadcaster.pub_tf.get_subscription_count() == 1)
    broadcaster.sendTransform(edge("one"))
    broadcaster.sendTransform([edge("two"), edge("three")])
    broadcaster.sendTransform(edge(f"arm_{index}") for index in range(2))
    static.sendTransform((edge("laser", 0.2),))
    wanted = {"map", "one", "two", "three", "arm_0", "arm_1", "laser"}
    spin_until(ros_executor, lambda: set(buffer._getFrameStrings()) == wanted)
    assert x_of(buffer, "laser") == 0.2
    assert buffer.lookup_transform("map", "three", LATEST) == edge("three")
    assert "broadcaster: 'default_authority'" in buffer.all_frames_as_yaml()
    listener.unregister()
    assert receiver.count_subscribers("/tf") == receiver.count_subscribers("/tf_static") == 0


def test_a_coroutine_waits_while_one_thread_spins(ros_node: Any, ros_executor: Any) -> None:
    node = ros_node("robot")
    buffer = Buffer(node=node)
    TransformListener(buffer, node)
    broadcaster = TransformBroadcaster(node)
    found: list[Any] = []

    async def look() -> None:
        timer.cancel()
        found.append(await buffer.lookup_transform_async("map", "base", LATEST))

    timer = node.create_timer(0.01, look, callback_group=ReentrantCallbackGroup())
    node.create_timer(0.1, lambda: broadcaster.sendTransform(edge("base")))
    spin_until(ros_executor, lambda: found)
    assert found == [edge("base")]


def test_late_listeners_get_all_static_transforms(ros_node: Any, ros_executor: Any) -> None:
    broadcaster = StaticTransformBroadcaster(ros_node("sender"))
    message = edge("laser")
    broadcaster.sendTransform(message)
    message.child_frame_id = "camera"  # programs fill one message again and again
    broadcaster.sendTransform(message)
    broadcaster.sendTransform(edge("laser", 0.3))
    buffer = Buffer()
    StaticTransformListener(buffer, ros_node("late"))  # kept by its subscriptions
    spin_until(ros_executor, lambda: len(buffer._getFrameStrings()) == 3)
    assert (x_of(buffer, "laser"), x_of(buffer, "camera")) == (0.3, 0.1)


def test_quality_of_service_and_topics(ros_node: Any, ros_executor: Any) -> None:
    node = ros_node("n")
    TransformBroadcaster(node, 7)
    TransformBroadcaster(node, None)
    StaticTransformBroadcaster(node)
    TransformListener(Buffer(), node)
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    TransformListener(
        Buffer(), node, qos=best_effort, static_qos=5, tf_topic="moves", tf_static_topic="stays"
    )
    TransformListener(Buffer(), node, static_only=True, tf_static_topic="only")
    spin_until(ros_executor, lambda: len(node.get_publishers_info_by_topic("/tf")) == 2)

    def durabilities(infos: Any) -> list[Any]:
        return [info.qos_profile.durability for info in infos]

    volatile, durable = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
    assert durabilities(node.get_publishers_info_by_topic("/tf")) == [volatile] * 2
    assert durabilities(node.get_publishers_info_by_topic("/tf_static")) == [durable]
    assert durabilities(node.get_subscriptions_info_by_topic("/tf")) == [volatile]
    assert durabilities(node.get_subscriptions_info_by_topic("/tf_static")) == [durable]
    assert durabilities(node.get_subscriptions_info_by_topic("/stays")) == [volatile]
    assert durabilities(node.get_subscriptions_info_by_topic("/only")) == [durable]
    (moves,) = node.get_subscriptions_info_by_topic("/moves")
    assert moves.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT


def test_a_listener_in_a_thread_of_its_own(ros_context: Any) -> None:
    """Nobody spins, and a lookup still gets what it waits for."""
    sender = rclpy.create_node("sender", context=ros_context)
    buffer = Buffer()
    listener = TransformListener(buffer, None, spin_thread=True)
    assert listener.node.get_name().startswith("transform_listener_impl_")
    StaticTransformBroadcaster(sender).sendTransform(edge("laser"))
    assert buffer.lookup_transform("map", "laser", LATEST, SOON).transform.translation.x == 0.1
    assert listener.dedicated_listener_thread.is_alive()
    sender.destroy_node()
    rclpy.shutdown(context=ros_context)
    listener.dedicated_listener_thread.join(20)
    assert not listener.dedicated_listener_thread.is_alive()


def test_a_listener_ends_with_its_node(ros_context: Any) -> None:
    if find_spec("rmw_local") is None:
        pytest.skip("the real executor keeps what was destroyed until something wakes it")
    node = rclpy.create_node("listener", context=ros_context)
    listener = TransformListener(Buffer(), node, spin_thread=True)
    thread, gone = listener.dedicated_listener_thread, weakref.ref(listener)
    node.destroy_node()
    del listener, node
    thread.join(0.01)
    gc.collect()
    thread.join(20)
    assert not thread.is_alive() and gone() is None


@contextmanager
def spinning(executor: Any) -> Iterator[None]:
    """Spin in a thread, because lookups of clients block."""
    done = threading.Event()

    def spin() -> None:
        try:
            while not done.is_set():
                executor.spin_once(timeout_sec=0.05)
        except ExternalShutdownException:
            pass

    thread = threading.Thread(target=spin)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


@pytest.fixture
def world(ros_context: Any, ros_node: Any) -> Iterator[tuple[Buffer, BufferServer, BufferClient]]:
    """A server with map -> base at 2 s and moon -> lander, and a client, both spinning."""
    executor = MultiThreadedExecutor(2, context=ros_context)
    buffer = Buffer()
    buffer.set_transform(edge("base"), "test")
    buffer.set_transform(edge("lander", parent="moon"), "test")
    server_node, client_node = (rclpy.create_node(name, context=ros_context) for name in ("server", "client"))
    executor.add_node(server_node)
    executor.add_node(client_node)
    server = BufferServer(buffer, server_node, "lookup")
    client = BufferClient(client_node, "lookup", check_frequency=10.0, timeout_padding=SOON)
    with spinning(executor):
        assert client.action_client.wait_for_server(20)
        yield buffer, server, client
    server.destroy()
    client.action_client.destroy()
    executor.shutdown()


def test_a_client_gets_what_the_buffer_has(world: Any) -> None:
    _, _, client = world
    assert client.lookup_transform("map", "base", Time(seconds=2)) == edge("base")
    assert client.lookup_transform("map", "base", Time(seconds=2).to_msg()) == edge("base")
    full = ("map", Time(seconds=2), "base", Time(seconds=2), "map")
    assert client.lookup_transform_full(*full) == edge("base")
    assert client.can_transform("map", "base", LATEST) and client.can_transform_full(*full)
    assert not client.can_transform("map", "arm", LATEST)
    assert not client.can_transform_full("map", LATEST, "arm", LATEST, "map")


@pytest.mark.parametrize(
    ("kind", "source", "time"),
    [
        (LookupException, "arm", LATEST),
        (ConnectivityException, "lander", LATEST),
        (ExtrapolationException, "base", Time(seconds=9)),
        (InvalidArgumentException, "/base", LATEST),
    ],
)
@pytest.mark.parametrize("timeout", [0.0, 0.05])
def test_a_client_gets_the_exceptions_of_the_buffer(
    world: Any, kind: type[TransformException], source: str, time: Time, timeout: float
) -> None:
    buffer, _, client = world
    with pytest.raises(TransformException) as own:
        buffer.lookup_transform_core("map", source, time)
    with pytest.raises(TransformException) as caught:
        client.lookup_transform("map", source, time, Duration(seconds=timeout))
    assert type(caught.value) is type(own.value) is kind
    assert str(caught.value) == str(own.value)


def test_a_client_waits_for_what_is_to_come(world: Any) -> None:
    buffer, server, client = world
    found: list[Any] = []
    waiting = threading.Thread(
        target=lambda: found.append(client.lookup_transform("map", "arm", LATEST, SOON))
    )
    waiting.start()
    while not server._pending:
        waiting.join(0.01)
    buffer.set_transform(edge("arm"), "test")
    waiting.join(20)
    assert found == [edge("arm")]
    assert server._pending == []


def test_a_lookup_can_be_cancelled(world: Any) -> None:
    _, server, _ = world
    node = server.node
    asks: ActionClient[Any] = ActionClient(node, LookupTransform, "lookup")
    goal = LookupTransform.Goal(target_frame="map", source_frame="arm", timeout=SOON.to_msg())

    def result_of(future: Any) -> Any:
        done = threading.Event()
        future.add_done_callback(lambda _: done.set())
        assert done.wait(20)
        return future.result()

    handle = result_of(asks.send_goal_async(goal))
    assert handle.accepted
    result = handle.get_result_async()
    assert len(result_of(handle.cancel_goal_async()).goals_canceling) == 1
    assert result_of(result).status == 5  # canceled
    asks.destroy()


def test_a_client_without_a_server(ros_node: Any, ros_executor: Any) -> None:
    client = BufferClient(ros_node("client"), "nobody")
    with pytest.raises(TimeoutException, match=r"The BufferServer is not ready\."):
        client.lookup_transform("map", "base", LATEST)
    client.action_client.destroy()


def test_a_server_that_nobody_spins(ros_node: Any, ros_context: Any) -> None:
    """Upstream would wait for ever."""
    idle = rclpy.create_node("idle", context=ros_context)
    server = BufferServer(Buffer(), idle, "lookup")
    node = rclpy.create_node("client", context=ros_context)
    client = BufferClient(node, "lookup", timeout_padding=0.1)
    assert client.action_client.wait_for_server(20)
    with pytest.raises(TimeoutException, match="did not come back in the specified time"):
        client.lookup_transform("map", "base", LATEST, Duration(seconds=0.1))
    client.action_client.destroy()
    server.destroy()
    node.destroy_node()
    idle.destroy_node()


def test_names_that_programs_import() -> None:
    for name in (
        "Buffer",
        "TransformListener",
        "TransformException",
        "TransformStamped",
        "TFMessage",
        "Time",
    ):
        assert hasattr(tf2_ros, name)
    from tf2_ros import buffer_client, buffer_interface, static_transform_broadcaster, transform_listener

    assert transform_listener.DEFAULT_TF_TOPIC == "/tf"
    assert buffer_client.BufferClient is BufferClient
    assert static_transform_broadcaster.StaticTransformBroadcaster is StaticTransformBroadcaster
    assert buffer_interface.TransformRegistration is tf2_ros.TransformRegistration
    assert tf2_ros.TFMessage is TFMessage and TF2Error.NO_ERROR == 0

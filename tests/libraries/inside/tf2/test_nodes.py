"""Listeners, broadcasters, and a buffer that other nodes ask."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from tf2_ros import (
    Buffer,
    StaticTransformBroadcaster,
    StaticTransformListener,
    TransformBroadcaster,
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


def test_a_callback_may_block_while_other_threads_spin(ros_node: Any, ros_context: Any) -> None:
    node = rclpy.create_node("robot", context=ros_context)
    buffer = Buffer()
    TransformListener(buffer, node)
    broadcaster = TransformBroadcaster(node)
    found: list[Any] = []

    def look() -> None:
        timer.cancel()
        found.append(buffer.lookup_transform("map", "base", LATEST, SOON))

    timer = node.create_timer(0.01, look)
    sending = node.create_timer(
        0.05, lambda: broadcaster.sendTransform(edge("base")), callback_group=ReentrantCallbackGroup()
    )
    executor = MultiThreadedExecutor(2, context=ros_context)
    executor.add_node(node)
    spin_until(executor, lambda: found)
    assert found == [edge("base")]
    sending.cancel()
    executor.shutdown()
    node.destroy_node()


def test_late_listeners_get_all_static_transforms(ros_node: Any, ros_executor: Any) -> None:
    broadcaster = StaticTransformBroadcaster(ros_node("sender"))
    message = edge("laser")
    broadcaster.sendTransform(message)
    message.child_frame_id = "camera"  # programs fill one message again and again
    broadcaster.sendTransform(message)
    broadcaster.sendTransform([edge("imu", 0.2), edge("imu", 0.3)])
    buffer = Buffer()
    StaticTransformListener(buffer, ros_node("late"))  # kept by its subscriptions
    spin_until(ros_executor, lambda: len(buffer._getFrameStrings()) == 4)
    assert [x_of(buffer, child) for child in ("laser", "camera", "imu")] == [0.1, 0.1, 0.3]


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

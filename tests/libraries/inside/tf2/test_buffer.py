"""Buffer: waiting for transforms, in threads and in coroutines."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock, ClockChange, ROSClock, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_msgs.srv import FrameGraph
from tf2_ros import (
    Buffer,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformListener,
)
from tf2_ros.transform_broadcaster import TransformBroadcaster

STAMP = Time(seconds=2)
FULL = ("map", STAMP, "base", STAMP, "map")


def edge(child: str = "base", stamp: Time = STAMP) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = "map", stamp.to_msg()
    message.transform.translation.x = 0.1
    return message


def test_what_is_there_is_returned_at_once() -> None:
    buffer = Buffer()
    buffer.set_transform(edge(), "test")
    assert buffer.lookup_transform("map", "base", STAMP) == edge()
    assert buffer.lookup_transform("map", "base", STAMP.to_msg(), timeout=Duration(seconds=5)) == edge()
    assert buffer.lookup_transform_full(*FULL, timeout=Duration(seconds=5)) == edge()
    assert buffer.can_transform("map", "base", STAMP, Duration(seconds=5)) == 1
    assert buffer.can_transform("map", "base", STAMP, return_debug_tuple=True) == (1, "")
    assert buffer.can_transform_full(*FULL) == 1


def test_a_thread_waits_until_it_is_there() -> None:
    buffer = Buffer()
    found: list[Any] = []
    waits = [
        lambda: buffer.lookup_transform("map", "base", STAMP, Duration(seconds=20)),
        lambda: buffer.lookup_transform_full(*FULL, Duration(seconds=20)),
        lambda: buffer.can_transform("map", "base", STAMP, Duration(seconds=20)),
        lambda: buffer.can_transform_full(*FULL, Duration(seconds=20)),
    ]
    threads = [threading.Thread(target=lambda wait=wait: found.append(wait())) for wait in waits]
    for thread in threads:
        thread.start()
    buffer.set_transform(edge("other"), "test")
    buffer.set_transform(edge(), "test")
    for thread in threads:
        thread.join(10)
    assert sorted(map(repr, found)) == sorted(map(repr, [edge(), edge(), True, True]))


def test_after_the_timeout_the_reason_is_said() -> None:
    buffer = Buffer()
    steady = Clock(clock_type=ClockType.STEADY_TIME)
    began = steady.now()
    with pytest.raises(
        LookupException, match='"map" passed to lookupTransform argument target_frame does not'
    ):
        buffer.lookup_transform("map", "base", STAMP, Duration(seconds=0.1))
    assert steady.now() - began >= Duration(seconds=0.1)
    buffer.set_transform(edge(), "test")
    possible, why = buffer.can_transform("map", "base", Time(seconds=9), Duration(seconds=0.01), True)  # type: ignore[misc]
    assert not possible and "extrapolation at time 9.000000" in why
    assert not buffer.can_transform("map", "base", Time(seconds=9), Duration(seconds=-1))
    assert len(buffer._waiting) == 0
    with pytest.raises(TypeError, match=r"timeout must be an rclpy\.duration\.Duration, got 1\.0"):
        buffer.lookup_transform("map", "base", STAMP, 1.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["lookup_transform_async", "lookup_transform_full_async"])
@pytest.mark.parametrize("first", [True, False])
def test_a_coroutine_waits(kind: str, first: bool) -> None:
    buffer = Buffer()
    coroutine = getattr(buffer, kind)(*(FULL if "full" in kind else ("map", "base", STAMP)))
    if first:
        buffer.set_transform(edge(), "test")
    else:
        coroutine.send(None)
        buffer.set_transform(edge("other"), "test")
        coroutine.send(None)
        buffer.set_transform(edge(), "test")
    with pytest.raises(StopIteration) as ended:
        coroutine.send(None)
    assert ended.value.value == edge()


def test_futures() -> None:
    buffer = Buffer()
    future, full = (
        buffer.wait_for_transform_async("map", "base", STAMP),
        buffer.wait_for_transform_full_async(*FULL),
    )
    cancelled = buffer.wait_for_transform_async("map", "base", STAMP)
    cancelled.cancel()
    buffer.set_transform_static(edge(), "test")
    assert future.done() and full.done() and future.result() == full.result() == edge()
    assert cancelled.cancelled()
    assert len(buffer._waiting) == 0
    never = buffer.wait_for_transform_async("map", "/base", STAMP)
    with pytest.raises(InvalidArgumentException):
        never.result()


def test_callbacks_of_futures_may_wait_for_more() -> None:
    buffer = Buffer()
    order: list[str] = []

    def next_one(_: Any) -> None:
        order.append("first")
        buffer.wait_for_transform_async("map", "arm", STAMP).add_done_callback(
            lambda _: order.append("second")
        )
        buffer.set_transform(edge("arm"), "test")

    buffer.wait_for_transform_async("map", "base", STAMP).add_done_callback(next_one)
    buffer.set_transform(edge(), "test")
    assert order == ["first", "second"]


def test_threads_that_could_complete_one_future() -> None:
    """Both have found the transform before either can say so."""
    both = threading.Barrier(2)

    class Slow(Buffer):
        def lookup_transform_core(self, *ends: Any) -> TransformStamped:
            transform = super().lookup_transform_core(*ends)
            both.wait(20)
            return transform

    buffer = Slow()
    future = buffer.wait_for_transform_async("map", "base", Time())
    results: list[Any] = []
    future.add_done_callback(lambda done: results.append(done.result()))
    threads = [threading.Thread(target=buffer.set_transform, args=(edge(), "test")) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(20)
    assert len(results) == 1 and future.result() is results[0]


def test_a_jump_back_in_time_clears_it() -> None:
    buffer = Buffer()
    buffer.set_transform(edge(), "test")
    buffer.time_jump_callback(TimeJump(ClockChange.ROS_TIME_NO_CHANGE, Duration(seconds=-2)))
    assert not buffer.can_transform("map", "base", Time())


def test_the_clock_of_its_node(ros_node: Any) -> None:
    node = ros_node("listener")
    clock = node.get_clock()
    assert isinstance(clock, ROSClock)
    buffer = Buffer(Duration(seconds=5), node)
    buffer.set_transform(edge(), "test")
    clock._set_ros_time_is_active(True)
    assert not buffer.can_transform("map", "base", Time())
    clock.set_ros_time_override(Time(seconds=100, clock_type=ClockType.ROS_TIME))
    for second, kept in ((99.5, True), (98.0, False)):
        buffer.set_transform(edge(), "test")
        clock.set_ros_time_override(Time(seconds=second, clock_type=ClockType.ROS_TIME))
        assert buffer.can_transform("map", "base", Time()) == kept


def test_the_service_tells_of_its_frames(ros_node: Any, ros_executor: Any) -> None:
    node = ros_node("listener")
    buffer = Buffer(node=node)
    buffer.set_transform(edge(), "test")
    client = node.create_client(FrameGraph, "tf2_frames")
    assert client.wait_for_service(10)
    future = client.call_async(FrameGraph.Request())
    ros_executor.spin_until_future_complete(future, 10)
    assert future.result().frame_yaml == buffer.all_frames_as_yaml() != "[]"


def test_in_virtual_time(ros_virtual_clock: Any, ros_node: Any, ros_executor: Any) -> None:
    """Waiting in a callback, a coroutine and a thread takes no real time, and ends at the right moment."""
    node = ros_node("robot")
    buffer = Buffer(node=node)
    listener = TransformListener(buffer, node)
    broadcaster = TransformBroadcaster(node)
    began = node.get_clock().now()
    seen: list[tuple[str, float]] = []

    def since() -> float:
        return round((node.get_clock().now() - began).nanoseconds * 1e-9, 3)

    async def look() -> None:
        timer.cancel()
        transform = await buffer.lookup_transform_async("map", "base", began + Duration(seconds=60))
        seen.append((transform.child_frame_id, since()))

    def wait() -> None:
        buffer.lookup_transform("map", "base", began + Duration(seconds=30), Duration(seconds=100))
        seen.append(("thread", since()))
        with pytest.raises(ExtrapolationException):
            buffer.lookup_transform("map", "base", began + Duration(seconds=3600), Duration(seconds=60))
        seen.append(("timeout", since()))

    timer = node.create_timer(1.0, look, callback_group=ReentrantCallbackGroup())
    node.create_timer(10.0, lambda: broadcaster.sendTransform(edge(stamp=node.get_clock().now())))
    thread = threading.Thread(target=wait)
    thread.start()
    while since() < 120:
        ros_executor.spin_once(timeout_sec=1.0)
    thread.join()
    listener.unregister()
    assert seen == [("thread", 30.0), ("base", 60.0), ("timeout", 90.0)]

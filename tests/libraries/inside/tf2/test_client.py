"""A buffer that other nodes ask."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.time import Time
from tf2_msgs.action import LookupTransform
from tf2_ros import (
    Buffer,
    BufferClient,
    BufferServer,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

SOON = Duration(seconds=20)
LATEST = Time()


def edge(child: str, x: float = 0.1, parent: str = "map") -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, Time(seconds=2).to_msg()
    message.transform.translation.x = x
    return message


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

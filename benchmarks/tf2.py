"""Transforms between frames: store them and look them up, in plain Python.

    python benchmarks/tf2.py [--rounds N]

A chain of 10 frames, each with 10 s of transforms at 100 Hz. All take turns. Process CPU time in
microseconds, medians over the rounds, garbage collection off. Upstream's `tf2_py`, its peer, has no wheel.
"""

from __future__ import annotations

import argparse
import gc
import math
from collections.abc import Callable
from typing import Any

import ifgen
from classes import in_turn, table

ifgen.activate("local")

import rclpy  # noqa: E402  # the local one
from geometry_msgs.msg import PoseStamped, TransformStamped  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.time import Time  # noqa: E402
from tf2_geometry_msgs import do_transform_pose_stamped  # noqa: E402
from tf2_ros import Buffer, TransformBroadcaster, TransformListener  # noqa: E402

LENGTH = 10
PERIOD = 10_000_000  # [ns]
LATEST = Time()
BETWEEN = Time(nanoseconds=500 * PERIOD + PERIOD // 3)


def edge(index: int, tick: int) -> TransformStamped:
    """The transform of a frame to the one before it, at a time."""
    message = TransformStamped(child_frame_id=f"link_{index + 1}")
    message.header.frame_id = f"link_{index}"
    message.header.stamp = Time(nanoseconds=tick * PERIOD).to_msg()
    angle = 0.001 * tick + 0.1 * index
    message.transform.translation.x = 0.1 * index
    message.transform.rotation.z, message.transform.rotation.w = math.sin(angle), math.cos(angle)
    return message


def filled(buffer: Buffer, *, static: bool) -> Buffer:
    """A buffer with the chain."""
    for index in range(LENGTH):
        if static:
            buffer.set_transform_static(edge(index, 1), "benchmark")
            continue
        for tick in range(1, 1001):
            buffer.set_transform(edge(index, tick), "benchmark")
    return buffer


def listening() -> Callable[[], None]:
    """Publish 20 transforms, and spin until a buffer has them."""
    rclpy.init()
    node, executor = rclpy.create_node("tf2"), SingleThreadedExecutor()
    executor.add_node(node)
    buffer = Buffer()
    listener = TransformListener(buffer, node)
    broadcaster = TransformBroadcaster(node)
    messages = [edge(index, 1) for index in range(20)]
    tick = 0

    def call() -> None:
        nonlocal tick
        tick += 1
        now = Time(nanoseconds=tick * PERIOD).to_msg()
        for message in messages:
            message.header.stamp = now
        broadcaster.sendTransform(messages)
        while not buffer.can_transform("link_19", "link_20", now):
            executor.spin_once(timeout_sec=0)
        assert listener.buffer is buffer

    return call


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=11)
    rounds = parser.parse_args().rounds
    gc.disable()
    moving, static = filled(Buffer(), static=False), filled(Buffer(), static=True)
    first, last = "link_0", f"link_{LENGTH}"
    pose, by = PoseStamped(), edge(0, 1)
    tick = 1000

    def store() -> None:
        nonlocal tick
        tick += 1
        message.header.stamp.sec, rest = divmod(tick, 100)
        message.header.stamp.nanosec = rest * PERIOD
        moving.set_transform(message, "benchmark")

    message = edge(LENGTH, 1)
    message.child_frame_id = "beside"
    operations: dict[str, tuple[Callable[[], Any], str]] = {
        "look up, static": (lambda: static.lookup_transform(first, last, LATEST), "30"),
        "look up, the latest": (lambda: moving.lookup_transform(first, last, LATEST), "30"),
        "look up, interpolated": (lambda: moving.lookup_transform(first, last, BETWEEN), "30"),
        "look up, interpolated, the other way": (lambda: moving.lookup_transform(last, first, BETWEEN), "30"),
        "ask whether one is there": (lambda: moving.can_transform(first, last, BETWEEN), ""),
        "store one": (store, ""),
        "transform a pose": (lambda: do_transform_pose_stamped(pose, by), ""),
        "publish 20, until a listener has stored them": (listening(), ""),
    }
    times = in_turn([operation for operation, _ in operations.values()], rounds)
    rows = [
        [what, f"{time * 1e6:.1f}", asked]
        for time, (what, (_, asked)) in zip(times, operations.items(), strict=True)
    ]
    print(table(["a chain of 10 frames", "us", "asked"], rows))


if __name__ == "__main__":
    main()

"""Decode with views of the received bytes beside decoding with a copy, and the same on the local transport.

    python benchmarks/views.py [--rounds N]

Both take turns. Process CPU time in microseconds, medians over the rounds, garbage collection off. `snapshot`
is one copy of the image's bytes (`bytes(image.data)`), which every publication needs.
"""

from __future__ import annotations

import argparse
import gc
from collections.abc import Callable
from typing import Any

import ifgen
from classes import interleaved, table

ifgen.activate("local")

import rclpy  # noqa: E402  # the local one
from ifgen_runtime import deserialize, serialize  # noqa: E402
from ifgen_runtime.codec.choice import chosen  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from sensor_msgs.msg import Image, JointState, LaserScan  # noqa: E402
from std_msgs.msg import String  # noqa: E402

IMAGE = Image(height=480, width=640, encoding="rgb8", step=1920, data=bytes(range(256)) * 3600)
NAMES = [f"left_arm_joint_{index}" for index in range(30)]
JOINTS = JointState(name=NAMES, position=[0.1] * 30, velocity=[0.1] * 30, effort=[0.1] * 30)
MESSAGES = {
    "Image, 0.9 MB": IMAGE,
    "LaserScan, 1,000 rays": LaserScan(ranges=[0.1] * 1000, intensities=[0.2] * 1000),
    "JointState, 30 joints": JOINTS,
}


def decoding(message: Any) -> tuple[Callable[[], Any], Callable[[], Any]]:
    """Decode with a copy, and with views."""
    data, cls = serialize(message), type(message)
    return lambda: deserialize(data, cls), lambda: deserialize(data, cls, views=True)


def topic(node: Any, executor: Any, message: Any, **options: Any) -> Callable[[], None]:
    """Publish, and spin until the callback has the message."""
    heard = 0

    def on_message(_: Any) -> None:
        nonlocal heard
        heard += 1

    name = f"{type(message).__name__}_{'_'.join(options)}"
    node.create_subscription(type(message), name, on_message, 10, **options)
    publish = node.create_publisher(type(message), name, 10).publish

    def call() -> None:
        before = heard
        publish(message)
        while heard == before:
            executor.spin_once()

    return call


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=11)
    rounds = parser.parse_args().rounds
    gc.disable()
    rows = []
    for what, message in MESSAGES.items():
        copying, viewing = interleaved(*decoding(message), rounds)
        rows.append([what, f"{copying * 1e6:.2f}", f"{viewing * 1e6:.2f}", f"{copying / viewing:.1f}x"])
    print(f"The codec is in {chosen().name}.\n")
    print(table(["decode", "copy", "views", "copy / views"], rows))
    rclpy.init()
    node, executor = rclpy.create_node("views"), SingleThreadedExecutor()
    executor.add_node(node)
    text, snapshot = interleaved(
        topic(node, executor, String(data="hello world")), lambda: bytes(IMAGE.data), rounds
    )
    copying, viewing = interleaved(
        topic(node, executor, IMAGE), topic(node, executor, IMAGE, views=True), rounds
    )
    figures = {
        "String": text,
        "Image, 0.9 MB": copying,
        "Image, 0.9 MB, views": viewing,
        "(snapshot)": snapshot,
    }
    print()
    print(
        table(["publish to callback", "us"], [[what, f"{time * 1e6:.1f}"] for what, time in figures.items()])
    )


if __name__ == "__main__":
    main()

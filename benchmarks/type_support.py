"""The cost of never-compiled classes on real rclpy, beside the compiled classes of the same types.

Publish and take in one thread, building the message included: CPU time, medians of interleaved rounds. The
last row sets the image from a numpy array of one dimension, the only shape that rosidl takes. Prints a
Markdown table; needs the ros wheels and ifgen-ros-native.
"""

from __future__ import annotations

import gc
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault("ROS_DOMAIN_ID", "97")
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "native" / "programs"))

import numpy as np
from common import never_compiled, rclpy, spin_until  # from the tests: it puts our packages on the path
from sensor_msgs.msg import Image, JointState

ROUNDS = 15
NAMES = [f"joint_{number}" for number in range(30)]
VALUES = [0.1 * number for number in range(30)]
PIXELS = bytes(640 * 480 * 3)
FRAME = np.zeros(640 * 480 * 3, np.uint8)


def joint_state(cls: type[Any]) -> Any:
    """A JointState of 30 joints."""
    return cls(name=NAMES, position=VALUES, velocity=VALUES, effort=VALUES)


def image(cls: type[Any]) -> Any:
    """An Image of 0.9 MB."""
    return cls(height=480, width=640, encoding="rgb8", step=1920, data=PIXELS)


def image_of_numpy(cls: type[Any]) -> Any:
    """The same Image, its pixels from numpy."""
    message = cls(height=480, width=640, encoding="rgb8", step=1920)
    message.data = FRAME
    return message


CASES = [
    ("JointState, 30 joints", "sensor_msgs/msg/JointState", JointState, joint_state, 400, 0.35),
    ("Image, 0.9 MB", "sensor_msgs/msg/Image", Image, image, 60, 0.5),
    ("Image, 0.9 MB, set from numpy", "sensor_msgs/msg/Image", Image, image_of_numpy, 2, 0.1),
]
"""Title, type, compiled class, a function that makes the message, messages in a round, the ratio asked."""


def exchange(
    node: Any, cls: type[Any], make: Callable[[type[Any]], Any], topic: str
) -> Callable[[int], float]:
    """A function that sends and takes the given number of messages; it returns the CPU time of one [us]."""
    publisher = node.create_publisher(cls, topic, 10)
    subscription = node.create_subscription(cls, topic, lambda message: None, 10)
    spin_until(node, publisher.get_subscription_count)

    def round_of(count: int) -> float:
        taken = 0
        start = time.process_time()
        while taken < count:
            publisher.publish(make(cls))
            with subscription.handle:
                taken += subscription.handle.take_message(cls, False) is not None
        return (time.process_time() - start) / count * 1e6

    return round_of


def main() -> None:
    """Measure and print."""
    rclpy.init()
    node = rclpy.create_node("benchmark")
    print("| message | compiled, us | never compiled, us | never compiled / compiled | asked |")
    print("|---|---:|---:|---:|---:|")
    for case, (title, type_name, compiled, make, count, asked) in enumerate(CASES):
        ours = never_compiled(type_name)
        rounds = {cls: exchange(node, cls, make, f"case_{case}_{cls is ours}") for cls in (compiled, ours)}
        gc.disable()
        times: dict[type[Any], list[float]] = {compiled: [], ours: []}
        for _ in range(ROUNDS):
            for cls, round_of in rounds.items():
                times[cls].append(round_of(count))
        gc.enable()
        theirs, mine = (statistics.median(times[cls]) for cls in (compiled, ours))
        print(f"| {title} | {theirs:,.1f} | {mine:,.1f} | {mine / theirs:.3f} | <= {asked} |", flush=True)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()

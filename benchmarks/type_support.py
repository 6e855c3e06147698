"""The cost of never-compiled classes on real rclpy, beside the compiled classes of the same types.

Publish and take in one thread, building the message included: CPU time, medians of interleaved rounds. Prints
a Markdown table; needs the ros wheels and ifgen-ros-native.
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

from common import never_compiled, rclpy, spin_until  # from the tests: it puts our packages on the path
from sensor_msgs.msg import Image, JointState

ROUNDS = 15
NAMES = [f"joint_{number}" for number in range(30)]
VALUES = [0.1 * number for number in range(30)]
PIXELS = bytes(640 * 480 * 3)


def joint_state(cls: type[Any]) -> Any:
    """A JointState of 30 joints."""
    return cls(name=NAMES, position=VALUES, velocity=VALUES, effort=VALUES)


def image(cls: type[Any]) -> Any:
    """An Image of 0.9 MB."""
    return cls(height=480, width=640, encoding="rgb8", step=1920, data=PIXELS)


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
    print("| type | compiled, us | never compiled, us | never compiled / compiled |")
    print("|---|---:|---:|---:|")
    for compiled, make, count in ((JointState, joint_state, 400), (Image, image, 60)):
        name = compiled.__name__
        ours = never_compiled(f"sensor_msgs/msg/{name}")
        rounds = {cls: exchange(node, cls, make, f"{name}_{cls is ours}") for cls in (compiled, ours)}
        gc.disable()
        times: dict[type[Any], list[float]] = {compiled: [], ours: []}
        for _ in range(ROUNDS):
            for cls, round_of in rounds.items():
                times[cls].append(round_of(count))
        gc.enable()
        theirs, mine = (statistics.median(times[cls]) for cls in (compiled, ours))
        print(f"| {name} | {theirs:.1f} | {mine:.1f} | {mine / theirs:.2f} |")
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()

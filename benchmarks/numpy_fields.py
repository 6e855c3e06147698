"""Assign numpy arrays to fields: ours beside rosidl's classes.

    python benchmarks/numpy_fields.py [--rounds N]

Both sets of classes are in one process and take turns; the figures are process CPU time in microseconds per
assignment, medians over the rounds, garbage collection off, checks off. `refused` is an error. Needs the
reference wheels.
"""

from __future__ import annotations

import argparse
import gc
from array import array
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np
from classes import interleaved, rosidl_types, table
from codec import our_types

FRAME = np.arange(480 * 640 * 3, dtype=np.uint32).astype(np.uint8).reshape(480, 640, 3)
ANGLES = np.linspace(-1.5, 1.5, 30)
"""The position of 30 joints [rad]."""


def cases() -> Iterator[tuple[str, str, str, Any]]:
    """A description, a message type, the field, and the value to assign to it."""
    image, joints, imu = "sensor_msgs/msg/Image", "sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu"
    yield "uint8, (480, 640, 3)", image, "data", FRAME
    yield "uint8, (921600,)", image, "data", FRAME.reshape(-1)
    yield "uint8, (240, 320, 3), every other row and column", image, "data", FRAME[::2, ::2]
    yield "int64, (480, 640, 3)", image, "data", FRAME.astype(np.int64)
    yield "float64, (480, 640, 3)", image, "data", FRAME.astype(np.float64)
    yield "bytes", image, "data", FRAME.tobytes()
    yield "memoryview", image, "data", memoryview(FRAME.tobytes())
    yield "float64, (30,)", joints, "position", ANGLES
    yield "float32, (30,)", joints, "position", ANGLES.astype(np.float32)
    yield "list of 30", joints, "position", ANGLES.tolist()
    yield "tuple of 30", joints, "position", tuple(ANGLES.tolist())
    yield "array.array of 30", joints, "position", array("d", ANGLES)
    yield "float64, (3, 3)", imu, "orientation_covariance", np.diag([0.1, 0.1, 0.2])
    yield "float32, (3, 3)", imu, "orientation_covariance", np.diag([0.1, 0.1, 0.2]).astype(np.float32)
    yield "list of 9", imu, "orientation_covariance", [0.1] * 9


def assign(cls: Any, field: str, value: Any) -> Any:
    """A function that assigns the value to a field of one message; None if the message refuses it."""
    message = cls()

    def run() -> None:
        setattr(message, field, value)

    with suppress(Exception):
        run()
        return run
    return None


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=11)
    rounds = parser.parse_args().rounds
    gc.disable()
    our_class, rows = our_types(), []
    for what, name, field, value in cases():
        ours, theirs = assign(our_class(name), field, value), assign(rosidl_types(name), field, value)
        our_time, their_time = interleaved(ours, theirs or ours, rounds)
        ratio = their_time / our_time
        peer = (
            [f"{their_time * 1e6:.2f}", f"{ratio:.{1 if ratio < 100 else 0}f}x"]
            if theirs
            else ["refused", "-"]
        )
        rows.append([f"{name.rpartition('/')[2]}.{field} = {what}", f"{our_time * 1e6:.2f}", *peer])
    print(table(["assignment", "ours", "rosidl", "rosidl / ours"], rows))


if __name__ == "__main__":
    main()

"""A user's node with arrays: what strict type checkers accept for fields of numbers, and what they refuse."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Image, Imu, JointState
from unique_identifier_msgs.msg import UUID


class SharedMemory:
    """A user's own object with the buffer protocol."""

    def __buffer__(self, flags: int, /) -> memoryview:
        return memoryview(bytes(flags))


def fill(
    frame: NDArray[np.uint8], anything: NDArray[Any], angles: NDArray[np.float64], octets: memoryview
) -> Image:
    image = Image(data=frame)
    image.data = anything
    image.data = frame.tobytes()
    image.data = bytearray(b"abc")
    image.data = octets
    image.data = SharedMemory()
    image.data = array("B", [1, 2])
    image.data = [1, 2]
    image.data = (pixel for pixel in (1, 2))
    image.data = "abc"  # refused: assignment, reportAttributeAccessIssue
    image.data = 1  # refused: assignment, reportAttributeAccessIssue
    image.data = [0.5]  # refused: list-item, reportAttributeAccessIssue

    joints = JointState(position=angles, velocity=angles.astype(np.float32))
    joints.effort = angles.reshape(3, 10)
    joints.position = [0.1, 1]
    joints.position = ["0.1"]  # refused: list-item, reportAttributeAccessIssue
    first: float = joints.position[0]
    print(first)

    imu = Imu(orientation_covariance=angles.reshape(3, 3))
    imu.orientation_covariance = array("d", [0.1] * 9)
    imu.orientation_covariance = (0.1,) * 9
    imu.orientation_covariance = 0.1  # refused: assignment, reportAttributeAccessIssue
    covariance: NDArray[np.float64] = imu.orientation_covariance
    print(covariance, UUID(uuid=bytes(16)), UUID(uuid=SharedMemory()))
    UUID(uuid="0")  # refused: arg-type, reportArgumentType
    return image

"""The messages that are exchanged: interfaces, and values for each of their fields."""

from __future__ import annotations

import base64
from typing import Any, Final

Value = dict[str, Any]
"""A message as plain data: a field that is a sequence of bytes is `{"base64": text}`."""

STRING: Final = "std_msgs/msg/String"
JOINT_STATE: Final = "sensor_msgs/msg/JointState"
IMU: Final = "sensor_msgs/msg/Imu"
TWIST: Final = "geometry_msgs/msg/Twist"
IMAGE: Final = "sensor_msgs/msg/Image"
SET_BOOL: Final = "std_srvs/srv/SetBool"
GET_PARAMETERS: Final = "rcl_interfaces/srv/GetParameters"
SET_PARAMETERS: Final = "rcl_interfaces/srv/SetParameters"
FIBONACCI: Final = "test_msgs/action/Fibonacci"

TYPES: Final = (
    *(STRING, JOINT_STATE, IMU, TWIST, IMAGE, SET_BOOL, GET_PARAMETERS, SET_PARAMETERS, FIBONACCI),
    # What actions are made of besides, and what the others hold.
    *("action_msgs/srv/CancelGoal", "action_msgs/msg/GoalStatusArray"),
    *("std_msgs/msg/Header", "builtin_interfaces/msg/Time", "geometry_msgs/msg/Vector3"),
    *("geometry_msgs/msg/Quaternion", "rcl_interfaces/msg/Parameter", "rcl_interfaces/msg/ParameterValue"),
)
"""Every interface that a program may need, by name."""

QOS: Final[Value] = {"reliable": True, "transient_local": False, "depth": 10}
BEST_EFFORT: Final[Value] = {"reliable": False, "transient_local": False, "depth": 5}
KEPT: Final[Value] = {"reliable": True, "transient_local": True, "depth": 3}


def message(type_name: str, number: int) -> Value:
    """A message of a topic with this number, which is in one of its fields; the first has the number 0."""
    makers = {STRING: _string, JOINT_STATE: _joint_state, IMU: _imu, TWIST: _twist}
    return makers[type_name](number)


def image(number: int, width: int, height: int) -> Value:
    """A picture in colours, of width x height pixels, whose bytes depend on its number."""
    line = bytes((column * 7 + number) % 251 for column in range(3 * width))
    return {
        "header": _header(number),
        "height": height,
        "width": width,
        "encoding": "rgb8",
        "is_bigendian": 0,
        "step": 3 * width,
        "data": {"base64": base64.b64encode(line * height).decode()},
    }


def _string(number: int) -> Value:
    return {"data": f"Grüße aus 0.1 m Höhe: {number}"}


def _header(number: int) -> Value:
    return {"stamp": {"sec": 1_700_000_000 + number, "nanosec": 999_999_999}, "frame_id": "base_link"}


def _joint_state(number: int) -> Value:
    return {
        "header": _header(number),
        "name": ["left_hip", "left_knee", ""],
        "position": [0.1, -1e-300, 0.1 * number],
        "velocity": [1.7976931348623157e308],
        "effort": [],
    }


def _vector(*numbers: float) -> Value:
    return dict(zip("xyz", numbers, strict=True))


def _imu(number: int) -> Value:
    return {
        "header": _header(number),
        "orientation": {"x": 0.1, "y": -0.2, "z": 0.3, "w": 0.9},
        "orientation_covariance": [0.1 * element for element in range(9)],
        "angular_velocity": _vector(0.1, -0.1, 1 / 3),
        "angular_velocity_covariance": [-1.0] * 9,
        "linear_acceleration": _vector(0.0, 0.1 * number, 9.81),
        "linear_acceleration_covariance": [0.01 * element for element in range(9)],
    }


def _twist(number: int) -> Value:
    return {"linear": _vector(0.1, -0.2, 0.1 * number), "angular": _vector(0.0, 1 / 3, -1e-300)}

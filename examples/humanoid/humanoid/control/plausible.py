"""Readings that cannot be true: numbers that are not finite, and values that no such robot can measure."""

from __future__ import annotations

import math

import numpy as np

from ..data import FootWrench, Imu, JointStates, Odometry
from ..robot.model import HumanoidModel
from ..spatial import Array

NOT_FINITE = "holds a number that is not finite"
_BEYOND = 0.5  # rad by which a measured joint can be out of its range
_SPEED = 100.0  # rad/s
_ACCELERATION = 2000.0  # m/s2: a landing foot causes hundreds
_FORCE = 20_000.0  # N
_FAR = 1e6  # m


def joints_problem(joints: JointStates, model: HumanoidModel) -> str:
    """The reason why joint states cannot be true, or ""."""
    position = joints.position
    beyond = float(np.maximum(position - model.upper, model.lower - position).max())
    if not beyond <= _BEYOND:
        return _words("/joint_states", beyond, f"a joint is {beyond:.2f} rad out of its range")
    return _beyond("/joint_states", joints.velocity, _SPEED, "rad/s")


def imu_problem(imu: Imu) -> str:
    """The reason why a reading of the IMU cannot be true, or ""."""
    return (
        _turn("/imu/data", imu.orientation)
        or _beyond("/imu/data", imu.angular_velocity, _SPEED, "rad/s")
        or _beyond("/imu/data", imu.linear_acceleration, _ACCELERATION, "m/s2")
    )


def wrench_problem(wrench: FootWrench) -> str:
    """The reason why the load on a foot cannot be true, or ""."""
    return _beyond("the wrench of a foot", wrench.force, _FORCE, "N")


def odometry_problem(odometry: Odometry) -> str:
    """The reason why odometry cannot be true, or ""."""
    return (
        _turn("/odom", odometry.orientation)
        or _beyond("/odom", odometry.position, _FAR, "m")
        or _beyond("/odom", odometry.linear_velocity, _SPEED, "m/s")
        or _beyond("/odom", odometry.angular_velocity, _SPEED, "rad/s")
    )


def _turn(where: str, orientation: Array) -> str:
    square = sum(value * value for value in orientation.tolist())
    return "" if 0.9 < square < 1.1 else _words(where, square, "the orientation is not a unit quaternion")


def _beyond(where: str, values: Array, most: float, unit: str) -> str:
    # Lists of Python numbers: numpy takes five times as long for a few, and this runs at every tick.
    if all(-most <= value <= most for value in values.tolist()):
        return ""
    largest = float(np.abs(values).max())
    return _words(where, largest, f"{largest:.3g} {unit} is not plausible")


def _words(where: str, number: float, what: str) -> str:
    return f"{where}: {what}" if math.isfinite(number) else f"{where} {NOT_FINITE}"

"""The kinds of time."""

from __future__ import annotations

from enum import IntEnum


class ClockType(IntEnum):
    """What a clock shows: ROS time (that /clock may drive), the system's, or a steady one."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3

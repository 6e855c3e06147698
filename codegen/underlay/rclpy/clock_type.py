"""The kinds of time."""

from __future__ import annotations

from enum import IntEnum


class ClockType(IntEnum):
    """The kinds of clocks: ROS time (which /clock may drive), system time, or steady time."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3

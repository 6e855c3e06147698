"""The executor that works in the order in which things happen."""

from __future__ import annotations

import rclpy
import rclpy.executors
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


def EventsExecutor(*, context: rclpy.Context | None = None) -> rclpy.executors.Executor:
    """Make an executor that runs callbacks on the thread that spins, in the order in which they became due.

    :param context: None for the default one.
    """
    executor: rclpy.executors.Executor = _rclpy.EventsExecutor(context)
    return executor
